/* scales: a picture's brightness at halved sizes, smoothed, as float: what patches are compared on.
 * Only a window of the picture is kept, so that a face in a large picture costs what the face costs. Places are px of the
 * whole picture, centre of the first pixel (0.5, 0.5), at level 0; at level l they are divided by 2^l.
 */
#ifndef IMAGE_SCALES_H
#define IMAGE_SCALES_H
#include <stdint.h>

enum { SCALES_LEVELS = 5 };

struct scale_level {
	int width, height, stride;
	float *px;             // [height][stride]; rows end in spare numbers that may be read
};

struct scales {
	int x0, y0;            // first pixel of the window; multiples of 2^(SCALES_LEVELS - 1)
	int levels;
	struct scale_level level[SCALES_LEVELS];
	float *store;          // of all levels; owned
	long room;
};

/* Of the pixels x0 <= x < x1, y0 <= y < y1, widened to whole cells; level 0 is smoothed by 1 2 1, each further one averages
 * 2 x 2 of the one before and is smoothed likewise. Scales filled before keeps its memory. scales_free. */
void scales_fill(struct scales *pyramid, const uint8_t *luma, int stride, int width, int height, int x0, int y0, int x1,
                  int y1, int levels);
void scales_free(struct scales *pyramid);

#endif
