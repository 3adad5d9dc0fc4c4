/* aspect: the aspect of one eye's limbus (vertical / horizontal) from its photographs, where it is not declared. One photograph alone can be of a
 * round limbus that is tilted up or of an oval one that is tilted aside: the posterior then has two hills.
 */
#ifndef LIMBUS_ASPECT_H
#define LIMBUS_ASPECT_H
#include "limbus/pose.h"

enum { ASPECT_RIVALS = 6 };

struct aspect {
	double likeliest, sigma;        // maximum of the posterior, standard deviation of the hill that it is on
	double elsewhere;               // probability of all other hills
	double rival[ASPECT_RIVALS];    // aspects that stand for them, as likely each
};

/* Searches the aspect on a grid over conf's Gaussian prior and a finer one. Each view's likelihood is integrated over the tilts near its two poses:
 * of the tilts that are as likely before, few are large ones that would look exactly like this.
 * False, err set, when a view has no pose. */
bool limbus_aspect(struct aspect *aspect, int n, const struct pose_view views[n], const struct eye *eye, const struct pose_conf *conf,
                   struct err *err);

/* Standard deviation of the whole posterior. */
double aspect_spread(const struct aspect *aspect);

#endif
