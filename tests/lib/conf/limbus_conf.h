/* The defaults of config/limbus.conf, for tests that call the library. */
#ifndef TESTS_LIMBUS_CONF_H
#define TESTS_LIMBUS_CONF_H
#include <math.h>

#include "limbus/evidence.h"
#include "limbus/find.h"
#include "limbus/pose.h"

static struct limbus_conf limbus_defaults = {
	.seek = { .min_radius = 0.015, .max_radius = 0.52, .contrast = 0.15, .candidates = 8 },
	.rim = { .search = 0.08, .max_rms = 0.15, .min_contrast = 0.15, .irregularity = 0.06, .straying = 6, .max_axis = 900, .passes = 6 },
	.pupil = { .min_contrast = 0.25, .min_coverage = 0.4, .clear_coverage = 0.7, .clear_used = 0.45, .largest = 0.85 },
	.face = { .distance = { 7.5, 13.5 }, .roll = 60 * M_PI / 180, .size_sigma = 0.03, .score = 0.3, .sure = 0.6, .pupil_sigma = 0.06 },
	.odds = { { { -2.017, -0.1555, 1.233, -0.3082, -0.04659, -1.808, -0.002853, -0.4675, -2.819, -0.0983, -0.1812, 0.9166, 0.2907, 0.0587, 0.3036, 0.324, -2.348, -0.6022, -4.515, 8.807, -0.1026, -0.05793 },
            { -0.4096, -0.3851, -1.25, -0.01099, 0.03553, -0.09281, -0.007554, -0.09639, -2.625, 2.163, 1.088, -3.775, -0.4461, -0.1248, -0.13, 0.598, -3.662, -2.353, -1.855, -0.7494, 0.3047, 0.1188 },
            { 0.9753, -0.2799, -1.629, 0.4026, 0.2019, -2.157, 0.8463, 0.6996, -1.587, 3.528, 1.717, -5.642, -0.5975, -0.186, -0.1035, 0.3176, 0.6258, 2.487, -1.695, -1.033, 0.1123, 0.1374 },
            { 2.084, 0.174, 0.6583, 0.215, -0.02967, -0.5047, -0.4296, 0.101, 4.352, 0.1612, 0.2912, 1.661, -0.1847, -0.05126, 0.273, -0.5887, 1.317, -5.079, 1.556, 1.88, 0.06164, 0.03329 },
            { 2.002, 0.1928, -3.68, 0.08975, 0.02054, -1.589, -0.2169, -0.4693, 5.254, 4.712, 0.4606, -2.023, -2.498, 0.2131, -0.4429, -0.1323, 1.661, 1.867, 0.2665, -3.21, -0.01352, -0.2256 },
            { -1.758, -0.2547, 0.9162, 0.008883, -0.003092, -1.879, -0.6078, 0.6756, -3.14, -6.442, 0.809, -8.621, -0.1548, -0.3184, -0.8187, -1.032, 2.076, -0.8227, -0.8824, 0.7744, -0.1846, -0.1746 } },
          { 1.582, 1.388, 1.534, -0.8899, -1.55, 1.166, -2.103 } },
	.region_sigma = 0.03, .region_shape_sigma = 0.02, .region_hidden = 1.5, .max_gross = 0.1, .sure_gross = 0.03, .max_rms = 0.008,
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
