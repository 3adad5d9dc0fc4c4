/* fine: refines a roughly known margin by segmentation: the boundary between eye and lid by colour histograms of the whole clip. The eye's histograms are by
 * rings about the iris, which look much the same all round, so that parts the lid covers in most frames are known from the sides; the lid's are by
 * places along it.
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
	float mm;                   // px in a millimetre
	float p[FINE_COLS][2];      // px: places along the margin, from the inner corner to the outer
	float out[FINE_COLS][2];    // unit: out of the opening
	uint16_t bin[FINE_COLS][FINE_CELLS];  // colours (lid_colour_bin), from within the opening outwards; cell FINE_MIDDLE on the margin
};

/* Distance between two cells, px. */
static inline double lid_fine_step(const struct lid_fine *fine)
{
	return (double)fine->mm / 32;
}

/* Samples the picture along a margin of n points (px, inner to outer corner). lower: 0 upper, 1 lower lid; mm: px in a
 * millimetre. fine: overwritten. */
void lid_fine_look(struct lid_fine *fine, int lower, int n, const double margin[][2], double mm, const struct lid_picture *picture);

/* A frame for lid_fine_settle(). */
struct lid_fine_frame {
	const struct lid_fine *look;
	double iris[3];             // limbus: centre and radius, px
	double expect[FINE_COLS];   // px out from look->p: expected end of the eye
	double end[FINE_COLS];      // px out from look->p: found; set by lid_fine_settle
};

/* Finds `end` in all frames of one margin: histograms from the frames, then the boundary in each by dynamic programming; twice. */
void lid_fine_settle(long n, struct lid_fine_frame *frames);

#endif
