/* cv_blur: Gaussian smoothing of float maps of any width, through OpenCV. */
#ifndef BRIDGE_CV_BLUR_H
#define BRIDGE_CV_BLUR_H
#ifdef __cplusplus
extern "C" {
#endif
#include "base/err.h"

/* out[height][width][channels] = in convolved with a Gaussian of `sigma` px, mirrored at the borders. in and out may be the same;
 * channels 1 to 4. A wide Gaussian (sigma > 6 px) is computed on an area-averaged copy whose texels are a third of sigma, and
 * interpolated back: it differs from the direct sum by less than 0.5 % of a unit step. Returns false, err set, where OpenCV
 * fails. */
bool cv_blur(float *out, const float *in, int width, int height, int channels, double sigma, struct err *err);

/* out[new_height][new_width][channels]: in resampled, area-averaged where smaller, bilinear where larger. Returns false, err set,
 * where OpenCV fails. */
bool cv_resize(float *out, int new_width, int new_height, const float *in, int width, int height, int channels,
               struct err *err);

#ifdef __cplusplus
}
#endif
#endif
