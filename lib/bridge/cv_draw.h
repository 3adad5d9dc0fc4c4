/* cv_draw: lines and words on 8-bit pictures, through OpenCV. px is [height][width][channels], 1 or 3 channels;
 * coordinates as in image.h: the centre of the first pixel is (0.5, 0.5). What lies outside is clipped. */
#ifndef BRIDGE_CV_DRAW_H
#define BRIDGE_CV_DRAW_H
#ifdef __cplusplus
extern "C" {
#endif
#include <stdbool.h>
#include <stdint.h>

struct cv_picture {
	uint8_t *px;
	int width, height, channels;
};

/* Draws an anti-aliased line through points xy[n], px, to 1/16 px. closed: back to the first; thickness: px. colour: R G B,
 * 0..255. */
void cv_draw_line(const struct cv_picture *picture, int n, const float (*xy)[2], bool closed, int thickness,
                  const uint8_t colour[3]);

/* Draws text whose capitals are `height` px high, with its base line beginning at (x, y), px. A character outside ASCII becomes
 * '?'. Returns its width in px; colour null: draws nothing. */
int cv_draw_text(const struct cv_picture *picture, double x, double y, double height, const char *text,
                 const uint8_t colour[3]);

#ifdef __cplusplus
}
#endif
#endif
