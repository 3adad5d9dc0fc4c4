/* shading: how the light of an iris changes with its relief, to first order, as a linear operator on maps of ln thickness.
 *
 * In layers that stand d ln T higher at a place, light changes by two things (against Monte Carlo of five tissues: tests/unit/tissue/test_shading.c):
 * - thicker stroma sends back more, alpha = d ln R / d ln T of parallel layers. Light that walks sideways spreads this, as
 *   tissue_spread_map does.
 * - slanted light enters elsewhere than straight above the place where it scatters: at the depth u at x + u s, s its slant. It is weakened by
 *   the thickness there, not here. With the first-order march of tissue.h through parallel layers, linearised,
 *       d ln L(x) = sum over depths u of weight(u) (h(x) - mean over the slants s of h(x + u s)),  h = T d ln T.
 *   What faces the light is bright, hollows are dark; of slants only mean and covariance count (four of them stand for all).
 */
#ifndef TISSUE_RELIEF_SHADING_H
#define TISSUE_RELIEF_SHADING_H
#include "image/image.h"
#include "tissue/tissue.h"

enum { SHADING_DEPTHS = 6, SHADING_SLANTS = 4 };

struct shading {
	int n;                 // texels a side
	double scale;          // texels a mm
	double spread;         // mm
	double depth[SHADING_DEPTHS], weight[SHADING_DEPTHS];  // mm; 1 / mm
	float *alpha, *thick;  // [n][n]: d ln R / d ln T; T, mm
	float (*slant)[SHADING_SLANTS][2];  // [n][n]: texels sideways, towards the light, for a mm of depth
	float *map[2];         // scratch [n][n]
};

/* Fills depths, weights and the spread: of that tissue, with a stroma of `thickness` mm, light of that mean cosine. alpha, thick and slant are new,
 * to be filled by the caller (shading_slants). shading_free. */
void shading_make(struct shading *shading, int n, double scale, const struct tissue *tissue, const struct tissue_optics *optics, double thickness,
                  double cos_view, double cos_light);
void shading_free(struct shading *shading);

/* Four slants of that mean and covariance (x, y; xx, xy, yy), mm for a mm; `to`: one texel of shading->slant. */
void shading_slants(float to[SHADING_SLANTS][2], double scale, const double mean[2], const double covariance[3]);

/* out[n][n] = the change of ln light that the change d[n][n] of ln thickness makes, none beyond the map; and the transposed of that. out and d
 * differ. The same bits for any number of threads. */
void shading_apply(float *out, const float *d, struct shading *shading);
void shading_transposed(float *out, const float *light, struct shading *shading);

/* The squared response to a wave of relief of that wave vector, 1 / texel, where alpha, thickness and slants are those. */
double shading_response(const struct shading *shading, double alpha, double thick, float (*const slant)[2], const double k[2]);

#endif
