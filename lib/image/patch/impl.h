/* What the files of patch share. */
#ifndef IMAGE_PATCH_IMPL_H
#define IMAGE_PATCH_IMPL_H
#include "image/patch/patch.h"

enum { P = 6, LANES = 16 };  // x, y, and A row by row

/* One patch at one level. */
struct template {
	bool usable;
	float *rows;        // [P + 2][padded]: weighted derivatives made orthogonal to template and constant; weighted template less
	                    // its mean; weight
	double H[P][P];     // of the derivatives
	double weight, energy;  // sum of the weights; of weight (T - mean)^2
};

struct patch_set {
	struct patch_conf conf;
	int n, count, padded;
	float *dx, *dy;     // [padded] px from the centre
	struct template *template;  // [n][SCALES_LEVELS]
};

/* Rows of scratch live on the stack: patches are small. */
enum { RADIUS_MAX = 24, ROOM = (2 * RADIUS_MAX + 1) * (2 * RADIUS_MAX + 1) + LANES };

/* Samples a level's brightness at (m[0] + m[2] dx + m[3] dy, m[1] + m[4] dx + m[5] dy), bilinear, for n offsets. */
void patch_sample(float *restrict out, const float *restrict px, int stride, int n, const float *restrict dx, const float *restrict dy, const float m[6]);

/* The warp in index coordinates of a level; false when a corner of the patch, `reach` px from its centre, is outside. */
bool patch_place(float m[6], const struct scales *picture, int level, const struct patch_warp *warp, double reach);

#endif
