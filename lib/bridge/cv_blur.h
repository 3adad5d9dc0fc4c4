/* cv_blur: Gaussian smoothing of float maps of any width, through OpenCV. */
#ifndef BRIDGE_CV_BLUR_H
#define BRIDGE_CV_BLUR_H
#ifdef __cplusplus
extern "C" {
#endif
#include "base/err.h"

/* out[height][width][channels] = in convolved with a Gaussian of `sigma` px; mirrored at the borders. in and out may be
 * the same. channels 1 to 4. Wide ones (sigma > 6 px) are computed on an area-averaged copy whose texels are a third of
 * sigma and interpolated back: against the direct sum the difference is below 0.5 % of a unit step. */
bool cv_blur(float *out, const float *in, int width, int height, int channels, double sigma, struct err *err);

/* out[new_height][new_width][channels]: area-averaged where smaller, bilinear where larger. */
bool cv_resize(float *out, int new_width, int new_height, const float *in, int width, int height, int channels,
               struct err *err);

#ifdef __cplusplus
}
#endif
#endif
