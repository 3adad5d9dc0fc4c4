/* gaze_bundle: eyeball, limbus and all directions of gaze of one eye together, from the edges of a whole clip.
 */
#ifndef TRACK_GAZE_BUNDLE_H
#define TRACK_GAZE_BUNDLE_H
#include "track/gaze/edge.h"

struct gaze_frame {
	struct gaze_view view;
	double fick[2];           // in: roughly; out
	const struct gaze_edge *edge;
	int n;
};

struct gaze_bundle_conf {
	double center_sigma, radius_sigma, limbus_sigma;  // mm: how far the truth may be from the start
};

struct gaze_bundle_fit {
	double sigma[GAZE_N];     // mm; of centre, radius, limbus (GAZE_X ..)
	double rms;               // px, of the edges that agree
	int iterations;
};

/* Robust (Tukey) Gauss-Newton with the directions eliminated frame by frame (Schur complement); at most 400 frames and 48
 * edges of each are used. globe: in, the start and the centre of the prior. False: fewer than two frames, or singular;
 * globe then is as it was. */
bool gaze_bundle_fit(struct gaze_globe *globe, struct gaze_bundle_fit *fit, int n, struct gaze_frame frame[],
                   const struct gaze_bundle_conf *conf);

#endif
