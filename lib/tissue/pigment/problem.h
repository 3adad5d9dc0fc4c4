/* problem: the least-squares problem of pigment_solve: residuals of all classes, then of the priors.
 * The stroma's thickness is known as a profile, not place by place: classes of a ring that were told apart by their light (struct
 * pigment_classes) stand at thicknesses
 *     profile exp(common + offset[ring] + spread[ring] z)
 * with z the level's standard score. common, the offsets and ln spread are unknowns beside the nine of pigment.h, held by priors of
 * their own and marginalised: so contrast inside a ring is not taken for a thickness that was guessed from that contrast.
 * The border layer's melanin differs from ring to ring (conf->melanin_ring > 0): e[ring] less their mean is added to its logarithm, so
 * that PIGMENT_ABL_MELANIN stays that of the whole iris. The e are unknowns with a prior of their own, too.
 */
#ifndef TISSUE_PIGMENT_PROBLEM_H
#define TISSUE_PIGMENT_PROBLEM_H
#include "tissue/pigment/pigment.h"

enum { PROBLEM_N_MAX = PIGMENT_N + 1 + 3 * PIGMENT_RINGS_MAX, PROBLEM_M_MAX = 3 * PIGMENT_CLASSES_MAX + PROBLEM_N_MAX };

struct pigment_problem {
	const struct pigment_classes *classes;
	const struct pigment_conf *conf;
	struct tissue_bands bands;
	int n, m;                                    // unknowns, residuals
	double mean[PROBLEM_N_MAX], sigma[PROBLEM_N_MAX], lower[PROBLEM_N_MAX], upper[PROBLEM_N_MAX];  // priors and bounds
};

void pigment_problem_make(struct pigment_problem *problem, const struct pigment_classes *classes, const struct pigment_conf *conf);

/* Thickness of class i, mm, at these unknowns. */
double pigment_problem_thickness(const struct pigment_problem *problem, const double x[], int i);

/* ln thickness that ring r has beyond its profile; ln melanin of its border layer beyond the iris' own. */
double pigment_problem_beyond(const struct pigment_problem *problem, const double x[], int r);
double pigment_problem_melanin(const struct pigment_problem *problem, const double x[], int r);

/* Index of e[0] in x; -1: melanin is the same in all rings. */
int pigment_problem_rings_at(const struct pigment_problem *problem);

/* Residuals of one class under a reflectance that the photograph should show; conf: their errors. */
void pigment_class_residuals(double r[3], const struct pigment_class *class, const double rgb[3], const struct pigment_conf *conf);

/* An nls_fn; ctx: the problem. Residuals of a class are logarithms: of its luminance (green), which shadows change as well, and of two
 * chromatic ratios, which they do not change. */
bool pigment_residuals(void *ctx, const double *x, double *r, double *J);

#endif
