/* bundle: bundle adjustment of one eye: globe, limbus radius and the gaze of every frame, from the limbus edges of a whole
 * clip. */
#ifndef TRACK_GAZE_BUNDLE_H
#define TRACK_GAZE_BUNDLE_H
#include "track/gaze/edge.h"

struct gaze_frame {
	struct gaze_view view;
	double fick[2];           // h, v, radians; in: start; out: estimate
	const struct gaze_edge *edge;
	int n;
};

struct gaze_bundle_conf {
	double center_sigma, radius_sigma, limbus_sigma;  // mm, standard deviations of the prior about the start
	double edge_sigma;        // share of the limbus' radius by which the edges of one gaze err together, beyond their scatter
	double edge_px;           // px by which they do, however small it is
};

enum { GAZE_GLOBE = GAZE_N - GAZE_X };  // unknowns that all frames share: centre, radius, limbus

struct gaze_bundle_fit {
	double cov[GAZE_GLOBE][GAZE_GLOBE];  // mm², of those
	double rms;               // px, of the inliers
	int iterations;
};

/* Gauss-Newton with Tukey weights; the directions are eliminated frame by frame (Schur complement). At most 400 frames and 48
 * edges of each are used. globe: in: start and mean of the prior; out: estimate.
 * Returns false, globe unchanged, with fewer than two frames or a singular system. */
bool gaze_bundle_fit(struct gaze_globe *globe, struct gaze_bundle_fit *fit, int n, struct gaze_frame frame[],
                   const struct gaze_bundle_conf *conf);

/* Covariance of a frame's h and v (radians²) that comes from the globe alone: all frames share one, and err together. NAN where
 * too few edges tell. */
void gaze_bundle_common(double cov[2][2], const struct gaze_frame *frame, const struct gaze_globe *globe, const struct gaze_bundle_fit *fit);

#endif
