/* cv_ridge: first and second derivatives of Gaussian-smoothed maps, through OpenCV. */
#ifndef BRIDGE_CV_RIDGE_H
#define BRIDGE_CV_RIDGE_H
#ifdef __cplusplus
extern "C" {
#endif
#include "base/err.h"

enum cv_derivative { CV_DX, CV_DY, CV_DXX, CV_DXY, CV_DYY, CV_DERIVATIVES };

/* The derivatives of `in`[height][width] convolved with a Gaussian of `sigma` px (>= 0.6), in units per px; mirrored at the borders.
 * out[k]: of enum cv_derivative, [height][width]; null: not wanted. Returns false, err set, where OpenCV fails. */
bool cv_ridge(float *const out[CV_DERIVATIVES], const float *in, int width, int height, double sigma, struct err *err);

#ifdef __cplusplus
}
#endif
#endif
