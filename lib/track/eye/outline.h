/* outline: where the evidence of the pixels (limbus/evidence.h) has the margins of an opening. No edge is measured, and nothing is learnt from the clip.
 * Image  px, centre of the first pixel (0.5, 0.5).
 */
#ifndef TRACK_EYE_OUTLINE_H
#define TRACK_EYE_OUTLINE_H
#include "limbus/evidence.h"
#include "track/eye/eye_track.h"

enum { OUTLINE_COLUMNS = 48 };

struct eye_outline {
	float radius;                        // of the iris, px
	float p[LIDS][OUTLINE_COLUMNS][2];   // px, at equal steps from the inner end of what shows to the outer; NAN where it has no margin
};

/* place: x, y and radius of the iris of an eye that looks straight on, px; across, down: unit vectors from the inner corner to the outer, and from it to the chin at right angles.
 * least_area: squares of that radius that must show. out: overwritten. Returns false where no eye shows there, or less of it. */
bool eye_outline_of(struct eye_outline *out, const struct evidence *evidence, const double place[3], const double across[2], const double down[2], double least_area);

/* How far the outline's margin lies from p, px along the unit vector `out`, which points out of the opening; the nearest such place within `most`. NAN where there is none. */
double eye_outline_apart(const struct eye_outline *outline, int lid, const double p[2], const double out[2], double most);

#endif
