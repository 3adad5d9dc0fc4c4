/* patch: small pieces of a reference picture found again in other pictures, under affine warps and changes of gain and
 * offset: inverse compositional alignment (Baker and Matthews 2004) with a Gaussian prior on the warp. Gain and offset are
 * projected out: the templates' derivatives are made orthogonal to the template and to a constant once and for all.
 * Places  px at level 0, centre of the first pixel (0.5, 0.5).
 * The bits do not depend on the instruction set.
 */
#ifndef IMAGE_PATCH_PATCH_H
#define IMAGE_PATCH_PATCH_H
#include <stdbool.h>

#include "image/scales.h"

/* A point x of the reference, d away from the patch's centre, is seen at `at` + A d. */
struct patch_warp {
	double at[2];
	double A[2][2];
};

struct patch_conf {
	int radius;            // of the patch in px of its level; what lies within about that of its centre counts
	int every;             // 1: all pixels; 2: every other one, as on a chessboard
	int iterations;        // at most, per level
	double stop;           // px of the level: a smaller step is the last
	double noise;          // of a pixel, 0..255: what the prior is weighed against
	double misfit;         // how many pixels err together where the patch does not fit: variance added a misfit's variance
};

/* What the warp is expected to be, and how well (standard deviations; INFINITY: anything). */
struct patch_prior {
	struct patch_warp mean;
	double at_sigma;       // px at level 0
	double A_sigma;
};

struct patch_fit {
	double ncc;            // weighted correlation with the template, -1..1
	double sigma;          // px: standard deviation of the place, from what the patch looks like, without the prior
	double step;           // px: the last step, at level 0
	int iterations;
};

struct patch_set;

/* n patches about `at` in the reference. weight: one float a pixel of the pyramid's window at level 0 ([height][stride] as
 * there), 0 where a pixel belongs to something else than the patches; null: all count. */
struct patch_set *patch_set_new(const struct scales *reference, int n, const double (*at)[2], const float *weight,
                                const struct patch_conf *conf);
void patch_set_free(struct patch_set *set);

/* Improves *warp at one level. prior may be null. False, warp untouched, when the patch leaves the picture, has no template
 * at that level, or the warp degenerates. Any number of threads at once. */
bool patch_align(struct patch_warp *warp, struct patch_fit *fit, const struct patch_set *set, int i, int level,
                 const struct scales *picture, const struct patch_prior *prior);

/* Only fit->ncc of a warp as it is. */
bool patch_look(struct patch_fit *fit, const struct patch_set *set, int i, int level, const struct scales *picture,
                const struct patch_warp *warp);

#endif
