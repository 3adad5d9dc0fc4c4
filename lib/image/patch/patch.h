/* patch: templates of a reference picture aligned to other pictures (Lucas-Kanade) under affine warps and changes of gain and
 * offset: the inverse compositional algorithm (Baker and Matthews 2004) with a Gaussian prior on the warp. Gain and offset are
 * projected out: the templates' derivatives are made orthogonal to the template and to a constant once.
 * Places  px at level 0, centre of the first pixel (0.5, 0.5).
 * Results are the same to the bit on every instruction set.
 */
#ifndef IMAGE_PATCH_PATCH_H
#define IMAGE_PATCH_PATCH_H
#include <stdbool.h>

#include "image/scales.h"

/* A point of the reference at offset d from the patch's centre is seen at `at` + A d. */
struct patch_warp {
	double at[2];
	double A[2][2];
};

struct patch_conf {
	int radius;            // of the patch, px of its level
	int every;             // 1: all pixels; 2: every other one, as on a chessboard
	int iterations;        // at most, per level
	double stop;           // px of the level: iteration ends after a smaller step
	double noise;          // standard deviation of a pixel, 0..255: weighs the data against the prior
	double misfit;         // number of pixels whose residuals are correlated: factor on the residual's variance that is added to noise
};

/* Gaussian prior of a warp: mean and standard deviations (INFINITY: no prior). */
struct patch_prior {
	struct patch_warp mean;
	double at_sigma;       // px at level 0
	double A_sigma;
};

struct patch_fit {
	double ncc;            // weighted correlation with the template, -1..1
	double sigma;          // px: standard deviation of the place from the template's texture, without the prior
	double step;           // px: the last step, at level 0
	int iterations;
};

struct patch_set;

/* Cuts n templates about the places `at` of the reference. patch_set_free.
 * weight  [height][stride] of the pyramid's window at level 0; 0 where a pixel belongs to something else; null: all count */
struct patch_set *patch_set_new(const struct scales *reference, int n, const double (*at)[2], const float *weight,
                                const struct patch_conf *conf);
void patch_set_free(struct patch_set *set);

/* Aligns patch i at one level, starting from *warp.
 * warp   in: start; out: refined; untouched on failure
 * prior  may be null
 * False when the patch leaves the picture, has no template at that level (outside the picture, too few pixels with weight, or
 * no texture), or the warp degenerates. May be called from several threads at once. */
bool patch_align(struct patch_warp *warp, struct patch_fit *fit, const struct patch_set *set, int i, int level,
                 const struct scales *picture, const struct patch_prior *prior);

/* Fills fit->ncc of a warp as it is, without aligning it. False as patch_align. */
bool patch_look(struct patch_fit *fit, const struct patch_set *set, int i, int level, const struct scales *picture,
                const struct patch_warp *warp);

#endif
