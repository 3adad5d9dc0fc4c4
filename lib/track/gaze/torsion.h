/* gaze_torsion: how far an eye is turned about its line of sight: the pattern of its iris on rings about the axis, seen
 * through the cornea, turned until it lies on what it was before.
 */
#ifndef TRACK_GAZE_TORSION_H
#define TRACK_GAZE_TORSION_H
#include "anatomy/eye.h"
#include "track/gaze/edge.h"

enum { TORSION_RINGS = 8, TORSION_RAYS_MAX = 720 };

struct gaze_torsion {
	int rays;                       // directions round the axis; 0: nothing is measured
	float mean[TORSION_RINGS][TORSION_RAYS_MAX], weight[TORSION_RINGS][TORSION_RAYS_MAX];  // the pattern so far
	long frames;
	double last;                    // radians
};

/* seen, ctx: as in struct gaze_search. eye: sizes for a usual limbus; scaled to globe's. */
struct torsion_look {
	const struct luma *luma;
	const struct gaze_globe *globe;
	const struct gaze_view *view;
	const struct eye *eye;
	double fick[2];
	gaze_seen_fn seen;
	const void *ctx;
};

/* torsion, sigma in radians, against the first frame, which is given the torsion `first`. False: too little iris to be seen,
 * or it is not like what it was. */
bool gaze_torsion(double *torsion, double *sigma, struct gaze_torsion *state, const struct torsion_look *look,
                  double first);

#endif
