/* The defaults of config/track.conf that lib/track/eye reads, for tests that call the library. */
#ifndef TESTS_EYE_TRACK_CONF_H
#define TESTS_EYE_TRACK_CONF_H
#include "track/eye/eye_track_opts.h"

static const struct eye_track_conf eye_track_review = {
	.limbus_arcs = 120, .lid_columns = 48, .lid_points = 20, .lid_wet = 0.13, .torsion_rays = 360, .still = 0.4, .evidence_px = 24, .edge_px = 0.25, .center_sigma = 0.5,
	.radius_sigma = 0.3, .limbus_sigma = 0.4, .saccade_speed = 40, .saccade_size = 1, .apart = { 8, 3 }, .poor = 0.6, .blink_depth = 0.25,
};

#endif
