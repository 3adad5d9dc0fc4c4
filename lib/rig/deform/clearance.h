/* deform_clearance: how near skin comes to the eyeballs. */
#ifndef RIG_DEFORM_CLEARANCE_H
#define RIG_DEFORM_CLEARANCE_H
#include "rig/rig.h"

/* Least distance of skin from an eyeball over 27 poses: gaze up to 20 degrees to the sides, 15 up and 25 down, lids closed, half open
 * and open. mm; below 0: skin is inside one. */
double deform_clearance(const struct rig *rig);

#endif
