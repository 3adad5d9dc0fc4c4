/* lid_fine: where on the picture the eye ends and its lid begins, along a margin that is roughly known, by the colours that the whole clip shows of
 * either: those of the eye by rings about the iris, which are much the same all round, so that what the lid hides in most frames is known from the sides;
 * those of the lid by places along it.
 * Image  px, centre of the first pixel (0.5, 0.5).
 */
#ifndef TRACK_LID_FINE_H
#define TRACK_LID_FINE_H
#include "track/lid/corner.h"
#include "track/lid/line.h"

enum { FINE_COLS = 56, FINE_CELLS = 65, FINE_MIDDLE = FINE_CELLS / 2 };

/* The picture along a margin of one frame, laid out straight. */
struct lid_fine {
	bool known;
	float mm;                   // px
	float p[FINE_COLS][2];      // px: places along the margin, from the inner corner to the outer
	float out[FINE_COLS][2];    // unit: out of the opening
	uint16_t bin[FINE_COLS][FINE_CELLS];  // colours (lid_colour_bin), from within the opening outwards; cell FINE_MIDDLE on the margin
};

/* The distance of two cells. */
static inline double lid_fine_step(const struct lid_fine *fine)
{
	return (double)fine->mm / 32;
}

/* Lays it out; mm: px. */
void lid_fine_look(struct lid_fine *fine, int lower, int n, const double margin[][2], double mm, const struct lid_picture *picture);

/* A frame for lid_fine_settle(). */
struct lid_fine_frame {
	const struct lid_fine *look;
	double iris[3];             // limbus: centre and radius, px
	double expect[FINE_COLS];   // px out from look->p: where the eye is thought to end
	double end[FINE_COLS];      // px out from look->p: where it does; out
};

/* All frames of a margin together. */
void lid_fine_settle(long n, struct lid_fine_frame *frames);

#endif
