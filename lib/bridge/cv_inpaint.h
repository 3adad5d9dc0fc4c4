/* cv_inpaint: OpenCV's inpainting, the peer of our fill of freckles in benchmarks. */
#ifndef BRIDGE_CV_INPAINT_H
#define BRIDGE_CV_INPAINT_H
#ifdef __cplusplus
extern "C" {
#endif
#include <stdint.h>

#include "base/err.h"

enum cv_inpaint_method { CV_INPAINT_TELEA, CV_INPAINT_NAVIER_STOKES };

/* Inpaints the pixels of rgb ([height][width][3], sRGB) where mask[height][width] is set, in place. radius: px. Returns false,
 * err set, where OpenCV fails. */
bool cv_inpaint(uint8_t *rgb, const uint8_t *mask, int width, int height, double radius, enum cv_inpaint_method method,
                struct err *err);

#ifdef __cplusplus
}
#endif
#endif
