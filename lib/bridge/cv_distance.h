/* cv_distance: OpenCV's distance transform, the peer of our own in benchmarks. */
#ifndef BRIDGE_CV_DISTANCE_H
#define BRIDGE_CV_DISTANCE_H
#ifdef __cplusplus
extern "C" {
#endif
#include <stdbool.h>
#include <stdint.h>

/* out[height][width]: Euclidean distance in px between the centres of each texel and of the nearest one where from[height][width]
 * is 0; the exact transform (DIST_MASK_PRECISE). Returns false where OpenCV fails. */
bool cv_distance(float *out, const uint8_t *from, int width, int height);

#ifdef __cplusplus
}
#endif
#endif
