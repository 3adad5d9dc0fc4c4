/* The defaults of config/limbus.conf, for tests that call the library. */
#ifndef TESTS_LIMBUS_CONF_H
#define TESTS_LIMBUS_CONF_H
#include <math.h>

#include "limbus/evidence.h"
#include "limbus/find.h"
#include "limbus/pose.h"

static struct limbus_conf limbus_defaults = {
	.seek = { .min_radius = 0.015, .max_radius = 0.52, .contrast = 0.15, .candidates = 8 },
	.rim = { .search = 0.08, .max_rms = 0.15, .min_contrast = 0.15, .irregularity = 0.06, .straying = 1, .max_axis = 900, .passes = 6 },
	.pupil = { .min_contrast = 0.25, .min_coverage = 0.4, .clear_coverage = 0.7, .clear_used = 0.45, .largest = 0.85 },
	.face = { .distance = { 7.5, 13.5 }, .roll = 60 * M_PI / 180, .size_sigma = 0.03, .score = 0.3, .sure = 0.6, .pupil_sigma = 0.06 },
	.odds = { { { 1.633, -0.01399, -0.9948, 0.1812, -0.1374, -2.549, -0.3532, 0.3551, 2.679, 2.444, 0.1207, -8.102, -0.2456, -0.3694, 0.0727, -0.459, 5.773, -2.275, -0.9205, 13.79, 0.06319, 0.004317 },
            { -6.302, -0.1943, 0.6807, -0.6324, -0.0175, 1.049, 0.7369, 0.5819, -0.8679, -2.492, -0.6773, 0.04709, 0.4589, -0.1686, -0.1017, 0.7656, -3.489, 14.75, -1.486, -9.094, 0.1192, -0.1832 },
            { 1.394, -0.4797, -0.8907, 0.363, 0.1996, 0.4355, 1.472, 0.3275, -3.61, -0.5509, 1.642, -5.686, -2.888, -0.4764, -0.3398, 0.5342, -1.076, -0.7108, -4.185, 0.6012, 0.413, 0.07255 },
            { 5.442, 0.1482, -1.837, 0.838, -0.06061, 4.958, -0.1352, 0.06304, -1.268, -0.2716, 0.2041, -12.33, 0.4374, -0.09955, -0.06028, 0.9667, 16.61, -0.249, -0.1242, 0.7869, 0.1932, 0.1827 },
            { 0.7372, 0.05998, -3.383, 0.1092, -0.2525, -0.0323, -0.3782, -0.0951, 3.005, 6.42, 0.4054, -0.5546, -1.317, -0.07164, -0.4353, -0.763, 6.346, 5.112, -0.1405, -5.673, 0.07224, -0.2786 },
            { -2.744, -0.1771, -1.006, -0.3735, 0.05849, -2.673, -0.4073, -0.9998, -6.134, 0.1896, 0.9461, 1.925, 2.619, 0.148, 0.1254, 0.7351, -0.09705, -5.593, -2.122, 3.322, -0.1105, -0.02588 } },
          { 2.344, 2.127, 2.589, -1.789, -2.059, 1.959, -2.032 } },
	.region_sigma = 0.03, .region_shape_sigma = 0.02, .region_hidden = 1.2, .max_gross = 0.1, .sure_gross = 0.03, .max_rms = 0.008,
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
