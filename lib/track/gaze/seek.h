/* gaze_seek: roughly where an eye looks, without an edge being measured: the direction under which the limbus has the most
 * dark inside it and bright outside.
 */
#ifndef TRACK_GAZE_SEEK_H
#define TRACK_GAZE_SEEK_H
#include "track/gaze/edge.h"

struct gaze_sight {
	const struct luma *luma;
	const struct gaze_globe *globe;
	const struct gaze_view *view;
	double contrast;           // grey levels of a full step
	gaze_seen_fn seen;         // where the limbus may be seen; null: everywhere
	const void *ctx;
};

/* fick: where to start; replaced by the best of the grid `reach` round it (radians), then refined by halving the step to
 * `fine`. Returns the mean share of a full step, -1..1: about 0 by chance, NAN when the eye is out of the picture. */
double gaze_seek(double fick[2], const struct gaze_sight *sight, double reach, double step, double fine);

#endif
