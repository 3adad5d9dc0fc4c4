#include <math.h>
#include <string.h>

#include "base/mem.h"
#include "math/simd.h"
#include "optics/lightpath/lightpath.h"
#include "optics/lightpath/path.h"

enum { BLOCK = 256 };  // a block's arrays stay in the first-level cache

// FAR: a last step of that length (mm) means convergence, which is quadratic: after a step of 2e-3 mm the error is below 1e-5 mm, after 1e-7
// below 1e-14. ILL: where the smaller curvature of L (1/mm) is below it, rounding of the gradient (1e-7 in float) moves K too far.
#define REAL double
#define SQRT sqrt
#define NAME(x) double_##x
#define FAR 1e-7
#define ILL 0.002
#include "optics/lightpath/lane.h"
#include "optics/lightpath/block.h"
#undef REAL
#undef SQRT
#undef NAME
#undef FAR
#undef ILL
#define REAL float
#define SQRT sqrtf
#define NAME(x) float_##x
#define FAR 2e-3
#define ILL 0.02
#include "optics/lightpath/lane.h"
#include "optics/lightpath/block.h"

void lightpath_batch(int n, const float *px, const float *py, const float *pz, const float *wx, const float *wy,
                     const float *wz, float *kx, float *ky, float *kz, unsigned char *status,
                     const struct cornea *cornea, int steps)
{
	float_run(&(struct float_batch){ { px, py, pz, wx, wy, wz }, { kx, ky, kz }, status, cornea, 0, 0 }, n, steps);
}

void lightpath_batch_point(int n, const float *px, const float *py, const float *pz, const double C[3], float *kx,
                           float *ky, float *kz, unsigned char *status, const struct cornea *cornea, int steps)
{
	float_run(&(struct float_batch){ { px, py, pz }, { kx, ky, kz }, status, cornea, C, 0 }, n, steps);
}

void lightpath_batch_double(int n, const double *px, const double *py, const double *pz, const double *wx,
                            const double *wy, const double *wz, double *kx, double *ky, double *kz,
                            unsigned char *status, const struct cornea *cornea, int steps)
{
	double_run(&(struct double_batch){ { px, py, pz, wx, wy, wz }, { kx, ky, kz }, status, cornea, 0, 0 }, n, steps);
}

void lightpath_batch_point_double(int n, const double *px, const double *py, const double *pz, const double C[3],
                                  double *kx, double *ky, double *kz, unsigned char *status,
                                  const struct cornea *cornea, int steps)
{
	double_run(&(struct double_batch){ { px, py, pz }, { kx, ky, kz }, status, cornea, C, 0 }, n, steps);
}

struct lightpath_again lightpath_batch_from(int n, const float *qx, const float *qy, const float *qz, const float *px, const float *py, const float *pz,
                          const float *wx, const float *wy, const float *wz, float *kx, float *ky, float *kz,
                          unsigned char *status, const struct cornea *cornea, int steps, double error_mm)
{
	return float_run(&(struct float_batch){ { px, py, pz, wx, wy, wz, qx, qy, qz }, { kx, ky, kz }, status, cornea, 0, error_mm }, n,
	                 steps);
}

/* Gain at K, which is passed in place of a start, in mm. */
SIMD_CLONES static void shine(struct float_block *b, const struct float_shared *c, int m)
{
	SIMD_LOOP
	for (int i = 0; i < m; i++) {
		float inv_t = 1 / (2 * c->R - c->p * b->qz[i]);
		b->x[i] = b->qx[i] * inv_t;
		b->y[i] = b->qy[i] * inv_t;
		float_lengths(b, i, c);
	}
	SIMD_LOOP
	for (int i = 0; i < m; i++)
		float_curve(b, i, c, false);
	SIMD_LOOP
	for (int i = 0; i < m; i++)
		float_caustic(b, i, c);
}

void lightpath_gain_batch(int n, const float *px, const float *py, const float *pz, const float *wx, const float *wy,
                          const float *wz, const float *kx, const float *ky, const float *kz, float *gain,
                          const struct cornea *cornea)
{
	struct float_shared shared = float_share(cornea, 0);
	struct float_block block;
	struct float_spare_lanes spare;
	const float *const in[] = { px, py, pz, wx, wy, wz, kx, ky, kz };
	for (int from = 0; from < n; from += BLOCK) {
		int m = n - from < BLOCK ? n - from : BLOCK;
		shine(&block, &shared, float_load(&block, &spare, in, (float *[3]){ 0 }, from, m));
		memcpy(gain + from, block.gain, (size_t)m * sizeof(float));
	}
}
