/* deform_along: lids go with an eye that looks up or down: lower ones as people's do, upper ones beyond what was filmed. */
#ifndef RIG_DEFORM_ALONG_H
#define RIG_DEFORM_ALONG_H
#include "rig/deform/clear.h"

/* mm above or below a margin, of an eyeball of 12 mm: skin goes along with it up to the first, not at all from the second. */
extern const double deform_goes_along_mm[2];

/* x  [rig.n], the target's frame, mm, in and out: the skin of one side;  target_from_globe  of its globe in this pose
 * lifted  mm by which expressions raise the lower lid, which is not taken back */
void deform_along(float (*x)[3], const struct rig *rig, const struct deform_near *near, int side, const double target_from_globe[3][3], double lifted);

#endif
