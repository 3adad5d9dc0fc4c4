/* torsion: rotation of an eye about its line of sight, by correlating the iris pattern, sampled on rings about the axis as seen
 * through the cornea, with the pattern of the frames before.
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

/* One frame. seen, ctx: as in struct gaze_search. eye: sizes of an average eye; scaled to globe's limbus. fick: h, v, radians. */
struct torsion_look {
	const struct luma *luma;
	const struct gaze_globe *globe;
	const struct gaze_view *view;
	const struct eye *eye;
	double fick[2];
	gaze_seen_fn seen;
	const void *ctx;
};

/* Estimates torsion and its sigma (radians) and adds the frame to the pattern. The first frame has the torsion `first` by
 * definition.
 * Returns false when too little of the iris is visible or it does not match the pattern. */
bool gaze_torsion(double *torsion, double *sigma, struct gaze_torsion *state, const struct torsion_look *look,
                  double first);

#endif
