/* deform_arcs: makes the upper lids' margins of a posed character arcs. Margins move by few components and slide over a cornea that stands out
 * 1.5 mm: where a lid is half way down its margin, arched at its ends and hollow between them, waves by up to a millimetre. */
#ifndef RIG_DEFORM_ARC_H
#define RIG_DEFORM_ARC_H
#include "rig/deform/clear.h"

/* Moves the upper lids' skin over the eyeballs, up or down, so that between the corners of the opening, as the front sees it, the margin has
 * curvature of one sign: the margin's convex hull, upper where it lies above the line between the corners in the mean and lower where it lies below,
 * brought to the same mean height. What is such an arc already stays; so do corners, the lower lids, and skin's distance from the
 * eyeball. What a character's own margin differs by from an arc at rest it keeps, in proportion to how high it is arched; where that is
 * more than 0.4 mm of an eyeball of 12 mm, lids are left as they are. Skin above goes along, the less the higher. Lids that are nearly shut are left: there the upper margin lies on the lower one.
 * x  [rig.n], the target's frame, mm, in and out;  target_from_globe  of both globes in this pose */
void deform_arcs(float (*x)[3], const struct rig *rig, const struct deform_near *near, const double target_from_globe[2][3][3]);

/* Lowers the lower lids of eyes that look down, as people's do, until they cover no more of the iris, at its middle, than the lid at rest does there of one that
 * looks to the same side: what was learnt of somebody whose lids are wide apart leaves a character's, which are not, across the pupil. As lids shut that
 * ends. Arguments as of deform_arcs. */
void deform_lower(float (*x)[3], const struct rig *rig, const struct deform_near *near, const double target_from_globe[2][3][3]);

/* The opening of an eye as the front sees it: heights of its upper and lower end over the eyeball's centre, mm, by column. */
enum { DEFORM_COLUMNS = 361 };
struct deform_opening {
	int first, last;               // columns that are open, in a row; none: last < first
	double step;                   // mm; column i is at step (i - DEFORM_COLUMNS / 2), along the head's x
	double top[DEFORM_COLUMNS], bottom[DEFORM_COLUMNS];
};

/* Exact for the mesh's faces, each column by itself; where the margin steps near an end, what is beyond lies behind it in the corner and is left out.
 * x: [rig.n]; within: heights between which an opening's middle lies, mm */
void deform_open(struct deform_opening *opening, const struct rig *rig, const struct deform_near *near, int side, const float (*x)[3], const double within[2]);

/* What deform_near_of has of the opening at rest; near->face is set. */
void deform_arcs_prepare(struct deform_near *near, const struct rig *rig);

/* deform_lower, deform_arcs, deform_clear: what follows deform_pose in pictures and in what leaves. */
void deform_settle(float (*x)[3], const struct rig *rig, const struct deform_near *near, const double target_from_globe[2][3][3]);

/* The largest distance of a chain y[n] below its upper convex hull. hull: [n] out */
double deform_hull(double *hull, int n, const double *y);

#endif
