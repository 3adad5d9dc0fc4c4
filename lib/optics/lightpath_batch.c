#include <math.h>
#include <string.h>

#include "base/mem.h"
#include "math/simd.h"
#include "optics/lightpath.h"
#include "optics/lightpath_path.h"

enum { BLOCK = 128 };  // a block's arrays stay in the first-level cache

// Newton converges quadratically: after a step of 5e-3 mm the error is below 1e-5, after 1e-6 below 1e-12. Where
// the smaller curvature of L is below ILL (1/mm), float's rounding of the gradient (1e-7) moves K too far.
#define REAL double
#define SQRT sqrt
#define NAME(x) double_##x
#define FAR2 1e-12
#define ILL 0
#include "optics/lightpath_lane.h"
#include "optics/lightpath_block.h"
#undef REAL
#undef SQRT
#undef NAME
#undef FAR2
#undef ILL
#define REAL float
#define SQRT sqrtf
#define NAME(x) float_##x
#define FAR2 2.5e-5f
#define ILL 0.02f
#include "optics/lightpath_lane.h"
#include "optics/lightpath_block.h"

void lightpath_batch(int n, const float *px, const float *py, const float *pz, const float *wx, const float *wy,
                     const float *wz, float *kx, float *ky, float *kz, unsigned char *status,
                     const struct cornea *cornea, int steps)
{
	float_run(&(struct float_batch){ px, py, pz, wx, wy, wz, kx, ky, kz, status, cornea, 0 }, n, steps);
}

void lightpath_batch_point(int n, const float *px, const float *py, const float *pz, const double C[3], float *kx,
                           float *ky, float *kz, unsigned char *status, const struct cornea *cornea, int steps)
{
	float_run(&(struct float_batch){ px, py, pz, 0, 0, 0, kx, ky, kz, status, cornea, C }, n, steps);
}

void lightpath_batch_double(int n, const double *px, const double *py, const double *pz, const double *wx,
                            const double *wy, const double *wz, double *kx, double *ky, double *kz,
                            unsigned char *status, const struct cornea *cornea, int steps)
{
	double_run(&(struct double_batch){ px, py, pz, wx, wy, wz, kx, ky, kz, status, cornea, 0 }, n, steps);
}

void lightpath_batch_point_double(int n, const double *px, const double *py, const double *pz, const double C[3],
                                  double *kx, double *ky, double *kz, unsigned char *status,
                                  const struct cornea *cornea, int steps)
{
	double_run(&(struct double_batch){ px, py, pz, 0, 0, 0, kx, ky, kz, status, cornea, C }, n, steps);
}
