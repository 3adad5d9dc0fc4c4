/* The defaults of config/limbus.conf, for tests that call the library. */
#ifndef TESTS_LIMBUS_CONF_H
#define TESTS_LIMBUS_CONF_H
#include <math.h>

#include "limbus/evidence.h"
#include "limbus/find.h"
#include "limbus/pose.h"

static struct limbus_conf limbus_defaults = {
	.seek = { .min_radius = 0.015, .max_radius = 0.52, .contrast = 0.15, .candidates = 8 },
	.rim = { .search = 0.08, .max_rms = 0.15, .min_contrast = 0.15, .irregularity = 0.06, .max_axis = 900, .passes = 6 },
	.pupil = { .min_contrast = 0.25, .min_coverage = 0.4, .clear_coverage = 0.7, .clear_used = 0.45, .largest = 0.85 },
	.face = { .distance = { 7.5, 13.5 }, .roll = 60 * M_PI / 180, .size_sigma = 0.03, .score = 0.3, .sure = 0.6, .pupil_sigma = 0.06 },
	.odds = { { { -4.814, -0.139, -0.1676, -0.721, -0.07795, -0.2209, -0.3032, 0.1659, -2.47, -2.002, 0.6268, -0.4199, 0.3481, -0.05056, -0.1813, 0.3092, 0.5945, -0.4681, -1.498, 2.526, -0.06685, -0.08711 },
	            { -3.414, -0.2529, -0.9864, -0.3877, -0.04456, 1.153, 0.2295, 0.7004, -0.1118, 1.015, 0.582, -1.436, -0.5339, -0.04767, 0.3293, -0.3369, -6.465, -1.55, -2.19, -0.0863, 0.1478, -0.1465 },
	            { 2.113, -0.3691, -1.612, 0.3558, 0.1244, -0.5663, 0.7613, 0.4996, -3.527, 0.4074, 1.27, -3.371, -1.459, -0.2064, -0.4057, 0.3775, 0.2345, -0.1041, -2.988, 0.3633, 0.382, 0.1342 },
	            { 1.28, 0.2099, 0.1165, 0.1369, 0.01562, -0.6398, 0.443, -0.2347, 1.758, 4.305, -0.5496, 6.251, 0.1866, 0.07016, 0.07246, -0.09425, -1.244, -0.2944, 0.9346, -0.03293, -0.1755, 0.03509 },
	            { 2.551, 0.1208, -1.25, 0.05461, -0.07727, -0.7895, 0.3018, -0.0429, 4.022, 3.362, -0.9495, -4.138, -4.115, 0.04284, 0.2836, -0.2355, 1.217, 1.098, 1.095, -2.071, 0.1959, -0.1676 },
	            { -4.568, -0.213, 1.365, -0.8151, -0.04782, -2.563, -0.6702, 0.02799, -2.296, -3.71, -0.7824, 1.031, 0.1763, -0.04586, 0.8763, 0.227, -1.409, -0.8927, -0.5533, 2.192, -0.0989, -0.01904 } },
	          { 1.237, 1.162, 1.783, -0.9305, -1.658, 1.368, -2.013 } },
	.region_sigma = 0.03, .region_shape_sigma = 0.02, .max_gross = 0.1, .sure_gross = 0.03, .max_rms = 0.008,
	.hint_sigma = 0.08, .drawn_sigma = 0.01, .max_over = 0.6, .min_level = 0.04,
};

/* Tests run in the repository; tools that run elsewhere find no eyes. */
__attribute__((constructor))
static void limbus_defaults_open(void)
{
	struct err err = { 0 };
	evidence_open(&limbus_defaults.net, "config/evidence.onnx", &err);
}

static const struct pose_conf pose_defaults = {
	.pupil_offset_sigma = 0.15, .depth_sigma = 0.25, .pupil_floor = 0.012, .aspect_mean = 1, .aspect_sigma = 0,
};

#endif
