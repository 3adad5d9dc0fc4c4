/* cv_flow: OpenCV's optical flow, the peer of our tracking of skin points in benchmarks. */
#ifndef BRIDGE_CV_FLOW_H
#define BRIDGE_CV_FLOW_H
#ifdef __cplusplus
extern "C" {
#endif
#include <stdint.h>

#include "base/err.h"

enum cv_flow_method { CV_FLOW_LUCAS_KANADE, CV_FLOW_DIS_FAST, CV_FLOW_DIS_MEDIUM, CV_FLOW_FARNEBACK };

/* Finds points from[n] of the picture `before` in `after`. Coordinates px, centre of the first pixel (0.5, 0.5).
 * to             [n] in: starts, used by Lucas-Kanade alone (window of 21 px, four levels); out: positions; a point not found
 *                keeps its start
 * before, after  [height][width], grey levels
 * The other methods are dense, with the settings of OpenCV's examples. Returns false, err set, where OpenCV fails. */
bool cv_flow(double (*to)[2], const double (*from)[2], int n, const uint8_t *before, const uint8_t *after, int width, int height,
             enum cv_flow_method method, struct err *err);

#ifdef __cplusplus
}
#endif
#endif
