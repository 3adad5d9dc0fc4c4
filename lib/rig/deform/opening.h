/* deform_opening: the opening of a posed eye, and hulls of its margins. */
#ifndef RIG_DEFORM_OPENING_H
#define RIG_DEFORM_OPENING_H
#include "rig/deform/clear.h"

/* The opening of an eye as the front sees it: heights of its upper and lower end over the eyeball's centre, mm, by column. */
enum { DEFORM_COLUMNS = 361, DEFORM_OPENING_LEAST = 20 };  // columns across it; so few are none
struct deform_opening {
	int first, last;               // columns that are open, in a row; none: last < first
	double step;                   // mm; column i is at step (i - DEFORM_COLUMNS / 2), along the head's x
	double top[DEFORM_COLUMNS], bottom[DEFORM_COLUMNS];
};

/* Fills near's edges, of all its faces; near_free frees them. */
void deform_edges_find(struct deform_near *near, const struct rig *rig);

/* A place about an eyeball's centre, along the head's axes, mm. */
void deform_in_head(double out[3], const struct rig *rig, int side, const float x[3]);

/* The same as seen from `aside` rad to the person's left. */
void deform_in_head_aside(double out[3], const struct rig *rig, int side, const float x[3], double aside);

/* Exact for the mesh's faces, each column by itself: what covers it begins and ends at edges with a face on one side alone, or folded back, of which there are few. Where the margin steps near an end, what is beyond lies behind it in the corner and is left out.
 * x: [rig.n]; within: heights between which an opening's middle lies, mm */
void deform_open(struct deform_opening *opening, const struct rig *rig, const struct deform_near *near, int side, const float (*x)[3], const double within[2]);

/* The same as seen from there. */
void deform_open_aside(struct deform_opening *opening, const struct rig *rig, const struct deform_near *near, int side, const float (*x)[3], const double within[2], double aside);

/* The largest distance of a chain y[n] below its upper convex hull. hull: [n] out */
double deform_hull(double *hull, int n, const double *y);

#endif
