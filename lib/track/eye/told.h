/* told: the opening of one eye as the evidence of the pixels tells it (limbus/evidence.h): where its corners are, and how much of it shows. No edge is measured, and
 * nothing is learnt from the clip.
 * Image  px, centre of the first pixel (0.5, 0.5).
 */
#ifndef TRACK_EYE_TOLD_H
#define TRACK_EYE_TOLD_H
#include "limbus/evidence.h"

struct eye_told {
	double corner[2][2];       // px: the ends of what shows against and along `across`; where lids meet a little further out
	double area;               // of what shows, in squares of the iris' radius: 5 to 9 of an open eye
};

/* place: x, y and radius of the iris of an eye that looks straight on, px; the largest patch of eye near it is taken. across: unit vector from the first corner to the second.
 * Returns false where no eye shows there. */
bool eye_told_of(struct eye_told *told, const struct evidence *evidence, const double place[3], const double across[2]);

#endif
