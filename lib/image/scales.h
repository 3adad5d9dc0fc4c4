/* scales: an image pyramid of a picture's brightness: halved sizes, smoothed, as float. image/patch compares patches on it.
 * Only a window of the picture is kept, so that the cost is that of the face and not of the picture.
 * Places are px of the whole picture at level 0, centre of the first pixel (0.5, 0.5); at level l they are divided by 2^l.
 */
#ifndef IMAGE_SCALES_H
#define IMAGE_SCALES_H
#include <stdint.h>

#include "base/pack.h"

enum { SCALES_LEVELS = 5 };

struct scale_level {
	int width, height, stride;
	float *px;             // [height][stride], brightness 0..255; rows end in spare numbers that may be read
};

struct scales {
	int x0, y0;            // first pixel of the window; multiples of 2^(SCALES_LEVELS - 1)
	int levels;
	struct scale_level level[SCALES_LEVELS];
	float *store;          // of all levels; owned
	long room;             // numbers that store has room for
};

/* Fills the pyramid from the pixels x0 <= x < x1, y0 <= y < y1 of a picture, widened to whole cells of the coarsest level.
 * pyramid  zeroed before the first call; one that was filled before keeps its memory; scales_free
 * luma     [height][stride] bytes
 * levels   1..SCALES_LEVELS
 * Level 0 is smoothed by 1 2 1 each way; each further level averages 2 x 2 of the one before and is smoothed likewise. */
void scales_fill(struct scales *pyramid, const uint8_t *luma, int stride, int width, int height, int x0, int y0, int x1,
                  int y1, int levels);
void scales_free(struct scales *pyramid);

/* base/pack.h. pyramid: zeroed, or filled before. */
void scales_pack(struct pack *pack, struct scales *pyramid);

#endif
