/* cv_stereo: dense matching of two rectified pictures by OpenCV (semi-global matching, Hirschmüller 2008). */
#ifndef BRIDGE_CV_STEREO_H
#define BRIDGE_CV_STEREO_H
#ifdef __cplusplus
extern "C" {
#endif
#include <stdint.h>

#include "base/err.h"

struct cv_stereo_conf {
	int block;         // px, odd: side of the window that is compared
	int uniqueness;    // %, the best cost has to undercut the second best by
	int left_right;    // px, the match from the other side may lie elsewhere by
	int speckle;       // px, smaller patches of their own depth are taken out
};

/* disparity[height][width]: x_left - x_right, px; NAN where nothing was found. Sought from min_disparity on, over `range`
 * values. Masked pixels (mask 0) get NAN. Results do not depend on threads. */
bool cv_stereo(float *disparity, const uint8_t *left, const uint8_t *right, const uint8_t *mask, int width, int height,
               int min_disparity, int range, const struct cv_stereo_conf *conf, struct err *err);

/* mask[height][width] becomes 0 where no two pixels of grey within `reach` px, across and down, differ by `least` levels. */
bool cv_mask_plain(uint8_t *mask, const uint8_t *grey, int width, int height, int reach, int least, struct err *err);

/* out[height][width]: the grey picture at (x[i], y[i]) px (first pixel's centre at 0.5), bilinear; mask: 255 where the
 * picture reaches, else 0. */
bool cv_warp8(uint8_t *out, uint8_t *mask, int width, int height, const float *x, const float *y, const uint8_t *px,
              int px_width, int px_height, struct err *err);

#ifdef __cplusplus
}
#endif
#endif
