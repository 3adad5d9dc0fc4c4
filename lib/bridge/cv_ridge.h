/* cv_ridge: first and second derivatives of Gaussian-smoothed maps, through OpenCV. */
#ifndef BRIDGE_CV_RIDGE_H
#define BRIDGE_CV_RIDGE_H
#ifdef __cplusplus
extern "C" {
#endif
#include "base/err.h"

/* out[height][width][5] = d/dx, d/dy, d2/dx2, d2/dxdy, d2/dy2 of `in`[height][width] convolved with a Gaussian of `sigma` px (>=
 * 0.6), in units per px; mirrored at the borders. Returns false, err set, where OpenCV fails. */
bool cv_ridge(float (*out)[5], const float *in, int width, int height, double sigma, struct err *err);

#ifdef __cplusplus
}
#endif
#endif
