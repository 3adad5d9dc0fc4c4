/* The defaults of config/limbus.conf, for tests that call the library. */
#ifndef TESTS_LIMBUS_CONF_H
#define TESTS_LIMBUS_CONF_H
#include <math.h>

#include "limbus/evidence.h"
#include "limbus/find.h"
#include "limbus/pose.h"
#include "limbus/strip_net.h"

static struct limbus_conf limbus_defaults = {
	.seek = { .min_radius = 0.015, .max_radius = 0.52, .contrast = 0.15, .candidates = 8 },
	.rim = { .search = 0.08, .max_rms = 0.15, .min_contrast = 0.15, .irregularity = 0.06, .straying = 1, .coarse_straying = 6, .colour_gain = 5, .rough_gain = 1.2, .max_axis = 900, .passes = 6 },
	.pupil = { .min_contrast = 0.25, .min_coverage = 0.4, .clear_coverage = 0.7, .clear_used = 0.45, .largest = 0.85,
		.first = { 0.12, 0.78 }, .first_contrast = 0.12, .first_score = 0.2, .least_window = 2, .told_sigma = { 0.025, 0.03 }, .told_sure = 0.5, .told_within = 0.05, .told_apart = 0.08,
		.told_used = 0.2, .brightest = 1.3, .other_eye = 0.5, .other_far = 2.2 },
	.face = { .distance = { 7.5, 13.5 }, .roll = 60 * M_PI / 180, .size_sigma = 0.03, .score = 0.3, .sure = 0.6, .pupil_sigma = 0.06,
		.region_alike = 0.5, .off_alike = 0.5, .off_sigma = 2, .broad = 0.3, .unlike = 0.01, .far = 4 },
	.trial = { .regions = 3, .votes = 4, .rounds = 2, .reads = 3, .passes = 4, .limbus_px = 110, .pupil_px = 70, .window_place = 0.5, .window_size = 0.3,
		.window_again = 0.2, .least_region = 0.3, .start_alike = 0.06, .other_scale = { 1.6, 0.62 }, .prior_arcs = 12, .strip_arcs = 150 },
	.same = { .sigmas = 3, .most = 0.05, .unseen = 0.08, .other_eye = 1, .moved = 0.5 },
	.hand = { .close = 0.12, .seen = 0.2 },
	.region_sigma = 0.03, .region_shape_sigma = 0.02, .region_hidden = 1.2, .strip_sigma = 0.005, .strip_conf = { 6, 30, 100, 0.02, 0.3, 0.3, 4, { 0.5, 0.5 }, { 0.3, 0.1 } },
	.tolerance = 0.02, .rough_tolerance = 0.06, .rough_gross = 0.05, .max_gross = 0.035, .sure_gross = 0.02, .max_rms = 0.008,
	.hint_sigma = 0.08, .drawn_sigma = 0.01, .max_over = 0.6, .min_level = 0.04,
};

/* Tests run in the repository; tools that run elsewhere find no eyes. */
__attribute__((constructor))
static void limbus_defaults_open(void)
{
	struct err err = { 0 };
	evidence_open(&limbus_defaults.net, "config/evidence.onnx", &err);
	strip_open(&limbus_defaults.strip, "config/strip.onnx", &err);
	odds_open(&limbus_defaults.odds, "config/odds.onnx", &err);
	occlusion_open(&limbus_defaults.occlusion, "config/occlusion.onnx", &err);
}

static const struct pose_conf pose_defaults = {
	.pupil_offset_sigma = 0.15, .depth_sigma = 0.25, .pupil_floor = 0.012, .aspect_mean = 1, .aspect_sigma = 0,
	.side_trust = 0.2, .opening = { .arm = 9.7, .sigma = 11 * M_PI / 180, .misled = 0.05 },
	.fellow = { .apart = 6 * M_PI / 180, .apart_sigma = 5 * M_PI / 180, .level_sigma = 2 * M_PI / 180, .squint = 0.03 },
};

#endif
