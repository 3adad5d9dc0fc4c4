/* corner: the corners of an eye tracked by the skin beside them. They move a millimetre or two when the eye turns and when the
 * lids are pressed together.
 */
#ifndef TRACK_LID_CORNER_H
#define TRACK_LID_CORNER_H
#include <math.h>

#include "track/lid/chart.h"

enum { CORNER_SIDE = 21, CORNER_REACH = 11, CORNER_FIELD = CORNER_SIDE + 2 * CORNER_REACH };

struct lid_picture {
	const uint8_t *rgb;    // [height][stride]
	int stride, width, height;
};

/* Bilinear colour at x, y (px), 0..255; clamped at the border. */
static inline void lid_picture_at(double out[3], const struct lid_picture *pic, double x, double y)
{
	double u = fmin(fmax(x - 0.5, 0), pic->width - 1.001), v = fmin(fmax(y - 0.5, 0), pic->height - 1.001);
	int i = (int)u, j = (int)v;
	double fu = u - i, fv = v - j;
	const uint8_t *p = pic->rgb + (long)j * pic->stride + 3L * i, *q = p + pic->stride;
	for (int c = 0; c < 3; c++) {
		double top = p[c] + fu * (p[c + 3] - p[c]), low = q[c] + fu * (q[c + 3] - q[c]);
		out[c] = top + fv * (low - top);
	}
}

struct lid_corner {
	bool known;
	uint8_t look[CORNER_SIDE][CORNER_SIDE];  // template: brightness beside the corner in the first frame
};

/* Tracks corner `which` (0 inner, 1 outer) by template matching. shift: columns and rows off the corner that the chart was laid
 * by, drawn towards 0 where the match is poor (blinks). The first call learns the template and gives 0, 0. */
void lid_corner_find(double shift[2], struct lid_corner *corner, int which, const struct lid_chart *chart,
                     const struct lid_picture *picture);

#endif
