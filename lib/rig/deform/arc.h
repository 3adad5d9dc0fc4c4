/* deform_settle: makes the upper lids' margins of a posed character arcs. Margins move by few components and slide over a cornea that stands out
 * 1.5 mm: where a lid is half way down its margin, arched at its ends and hollow between them, waves by up to a millimetre. */
#ifndef RIG_DEFORM_ARC_H
#define RIG_DEFORM_ARC_H
#include "rig/deform/opening.h"

/* What follows deform_pose in pictures and in what leaves: lowers lower lids, makes upper margins arcs, shuts what is all but shut, then
 * deform_clear; hair cards go with the skin that they stand on.
 * x  [rig.n], the target's frame, mm, in and out;  target_from_globe  of both globes in this pose
 * lifted  [2] mm by which expressions raise the left and the right lower lid (deform_lifted), which are not taken back; null: 0 */
void deform_settle(float (*x)[3], const struct rig *rig, const struct deform_near *near, const double target_from_globe[2][3][3], const double *lifted);

#endif
