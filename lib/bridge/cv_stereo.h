/* cv_stereo: dense stereo matching of two rectified pictures by OpenCV (semi-global matching, Hirschmüller 2008). */
#ifndef BRIDGE_CV_STEREO_H
#define BRIDGE_CV_STEREO_H
#ifdef __cplusplus
extern "C" {
#endif
#include <stdint.h>

#include "base/err.h"

struct cv_stereo_conf {
	int block;         // px, odd: side of the matching window
	int uniqueness;    // %, by which the best cost must be below the second best
	int left_right;    // px, greatest difference in the left-right consistency check
	int speckle;       // px, smaller connected patches of disparity are removed
};

/* Matches two rectified pictures.
 * disparity             [height][width] out: x_left - x_right, px; NAN where there is no match or mask is 0
 * left, right, mask     [height][width]
 * min_disparity, range  disparities searched: `range` values from min_disparity on, px
 * Returns false, err set, where OpenCV fails. The result does not depend on the number of threads. */
bool cv_stereo(float *disparity, const uint8_t *left, const uint8_t *right, const uint8_t *mask, int width, int height,
               int min_disparity, int range, const struct cv_stereo_conf *conf, struct err *err);

/* Masks regions without texture: mask[height][width] is set to 0 where no two pixels of grey within `reach` px, horizontally and
 * vertically, differ by `least` levels. Returns false, err set, where OpenCV fails. */
bool cv_mask_plain(uint8_t *mask, const uint8_t *grey, int width, int height, int reach, int least, struct err *err);

/* Resamples a grey picture px[px_height][px_width] at positions (x[i], y[i]), px, first pixel's centre at 0.5, bilinearly.
 * out   [height][width]
 * mask  [height][width] out: 255 where the position is inside the picture, else 0
 * Returns false, err set, where OpenCV fails. */
bool cv_warp8(uint8_t *out, uint8_t *mask, int width, int height, const float *x, const float *y, const uint8_t *px,
              int px_width, int px_height, struct err *err);

#ifdef __cplusplus
}
#endif
#endif
