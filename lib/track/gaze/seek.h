/* seek: rough direction of gaze by grid search: the direction whose projected limbus has the greatest contrast between dark
 * inside and bright outside; or, where the evidence of the pixels is given, whose limbus parts iris from sclera. No edges are measured.
 */
#ifndef TRACK_GAZE_SEEK_H
#define TRACK_GAZE_SEEK_H
#include "limbus/evidence.h"
#include "track/gaze/edge.h"

struct gaze_sight {
	const struct luma *luma;
	const struct gaze_globe *globe;
	const struct gaze_view *view;
	double contrast;           // grey levels of a full step
	gaze_seen_fn seen;         // where the limbus may be seen; null: everywhere
	const void *ctx;
	const struct evidence *evidence;  // of the pixels round the eye; null: brightness alone tells
};

/* fick: h, v, radians; in: middle of the grid; out: the best direction within `reach` of it on a grid of `step`, refined by
 * halving the step down to `fine`. Returns the contrast as a mean share of sight->contrast, -1..1, about 0 by chance; NAN when
 * the eye is out of the picture. */
double gaze_seek(double fick[2], const struct gaze_sight *sight, double reach, double step, double fine);

#endif
