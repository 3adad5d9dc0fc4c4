/* lid_corner: the corners of an eye found again by the skin beside them: they give way when the eye turns and when the lids
 * are pressed together, a millimetre or two.
 */
#ifndef SKIN_LID_CORNER_H
#define SKIN_LID_CORNER_H
#include "skin/lid_chart.h"

enum { CORNER_SIDE = 21, CORNER_REACH = 11, CORNER_FIELD = CORNER_SIDE + 2 * CORNER_REACH };

struct lid_picture {
	const uint8_t *rgb;    // [height][stride]
	int stride, width, height;
};

struct lid_corner {
	bool known;
	uint8_t look[CORNER_SIDE][CORNER_SIDE];  // brightness beside the corner in the first frame
};

/* Where corner `which` (0 inner, 1 outer) is: shift[2], columns and rows off the place that the chart was laid by. The first
 * call learns its looks and gives 0, 0. */
void lid_corner_find(double shift[2], struct lid_corner *corner, int which, const struct lid_chart *chart,
                     const struct lid_picture *picture);

#endif
