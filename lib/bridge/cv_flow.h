/* cv_flow: OpenCV's motion between two pictures, which the points of skin are measured against. */
#ifndef BRIDGE_CV_FLOW_H
#define BRIDGE_CV_FLOW_H
#ifdef __cplusplus
extern "C" {
#endif
#include <stdint.h>

#include "base/err.h"

enum cv_flow_method { CV_FLOW_LUCAS_KANADE, CV_FLOW_DIS_FAST, CV_FLOW_DIS_MEDIUM, CV_FLOW_FARNEBACK };

/* Where n points of the picture `before` are in `after`; both [height][width], grey levels. px, centre of the first pixel (0.5, 0.5).
 * to: on entry where to begin looking, which Lucas-Kanade alone asks (window of 21 px, four levels); a point that is not found
 * stays there. The others find the motion of all pixels, with their own settings as OpenCV's examples have them. */
bool cv_flow(double (*to)[2], const double (*from)[2], int n, const uint8_t *before, const uint8_t *after, int width, int height,
             enum cv_flow_method method, struct err *err);

#ifdef __cplusplus
}
#endif
#endif
