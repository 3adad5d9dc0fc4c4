/* The defaults of config/limbus.conf, for tests that call the library. */
#ifndef TESTS_LIMBUS_CONF_H
#define TESTS_LIMBUS_CONF_H
#include "limbus/find.h"
#include "limbus/pose.h"

static const struct limbus_conf limbus_defaults = {
	.seek = { .min_radius = 0.015, .max_radius = 0.52, .contrast = 0.15, .candidates = 8 },
	.rim = { .search = 0.08, .max_rms = 0.15, .min_contrast = 0.15, .irregularity = 0.06 },
	.pupil = { .min_contrast = 0.25, .min_coverage = 0.4 },
	.min_coverage = 0.35, .min_contrast = 0.08, .max_blur = 0.08, .max_rms = 0.008, .max_sigma = 0.015,
	.hint_sigma = 0.08, .drawn_sigma = 0.01, .max_flank_rms = 0.019, .max_flank_sigma = 0.045, .min_flank_coverage = 0.3, .max_over = 0.6, .min_level = 0.04,
};

static const struct pose_conf pose_defaults = {
	.pupil_offset_sigma = 0.15, .depth_sigma = 0.25, .pupil_floor = 0.012, .aspect_mean = 1, .aspect_sigma = 0,
};

#endif
