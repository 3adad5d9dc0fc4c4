/* deform_slide, deform_shut: a lid's skin goes over its eyeball. */
#ifndef RIG_DEFORM_SLIDE_H
#define RIG_DEFORM_SLIDE_H
#include "rig/deform/clear.h"

/* From so far to either side, rad, lids are looked at, too: what meets as the front sees it may gape there. */
#define DEFORM_ASIDE 0.5

/* Moves a place by `up` mm along the head's y, as far from the eyeball's surface as before. x: the target's frame, mm, in and out. */
void deform_slide(float x[3], const struct rig *rig, int side, const double target_from_globe[3][3], double up);

/* Lids that a pose leaves apart by less than what its components can tell meet: the upper one comes down to the lower one, column by column, and a little further.
 * Components are linear in gaze and aperture: what shuts an eye that looks straight ahead leaves a slit of some tenths of a millimetre where it looks
 * aside or down. From there to lids that are twice as far apart, the slit opens faster than it was asked to.
 * From in front and from DEFORM_ASIDE to either side.
 * x  [rig.n], the target's frame, mm, in and out: the skin of one side;  target_from_globe  of its globe in this pose */
void deform_shut(float (*x)[3], const struct rig *rig, const struct deform_near *near, int side, const double target_from_globe[3][3]);

#endif
