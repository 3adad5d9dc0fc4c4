/* disc: the iris as an ellipse in planes of evidence: iris and pupil inside, sclera outside, lids anywhere. */
#ifndef LIMBUS_DISC_H
#define LIMBUS_DISC_H
#include "limbus/evidence.h"

/* Fits it, from the region on, by a pattern search for the least evidence that contradicts: of sclera inside, of iris and pupil outside,
 * and a little of lid inside, so that it does not grow where lids hide it.
 * region  in: x, y and radius about right, px of the photograph; out: middle and longer semi-axis of the ellipse, and as score 0..1 the
 *         share of iris in all that is told, less where no sclera lies beside it, or little of it shows, or it is small or large for the
 *         network's scale. */
void disc_fit(struct evidence_region *region, const struct evidence *evidence);

#endif
