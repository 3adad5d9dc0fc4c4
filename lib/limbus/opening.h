/* opening: where between the corners of its lids an iris lies. An eye that looks aside, or a head that turns, moves it towards that side.
 */
#ifndef LIMBUS_OPENING_H
#define LIMBUS_OPENING_H
#include <stdbool.h>

#include "limbus/evidence.h"
#include "math/ellipse_type.h"

/* How far from the limbus's centre what shows between the lids reaches, towards -x and +x of the picture, semi-axes of the limbus. 0: the picture ends before. */
void opening_reach(double reach[2], const struct evidence *evidence, const struct ellipse *limbus, int width);

/* What that says of a tilt. */
struct opening_conf {
	double arm;     // mm: from the limbus's plane back to the point about which it turns, eye and head together, between the corners
	double sigma;   // rad: of the direction that it tells; <= 0: it is not asked
	double misled;  // chance that it says nothing: hair, a fold, a corner that is not seen
};

/* Whether it says anything. */
static inline bool opening_known(const double reach[2], const struct opening_conf *conf)
{
	return conf->sigma > 0 && reach[0] > 0 && reach[1] > 0;
}

/* Likelihood, over the largest, of an optical axis that points `aside` past the camera, rad, towards +x. limbus_radius: mm. */
double opening_likelihood(const double reach[2], double aside, double limbus_radius, const struct opening_conf *conf);

#endif
