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
	.pupil = { .min_contrast = 0.25, .min_coverage = 0.4, .clear_coverage = 0.7, .clear_used = 0.45, .largest = 0.85 },
	.face = { .distance = { 7.5, 13.5 }, .roll = 60 * M_PI / 180, .size_sigma = 0.03, .score = 0.3, .sure = 0.6, .pupil_sigma = 0.06 },
	.odds = { { { -2.341, 0.09699, 1.027, -0.03318, -0.1132, 0.1222, -1.045, -0.7429, 3.457, -2.901, -1.305, 5.76, 1.136, 0.3857, 0.3356, -0.4247, -3.198, -1.371, 3.373, -0.1625, -0.3183, -0.09717, 1.408, -0.5599, 0.4049, 0.007816, 0.02313, -0.06908, -0.1173, 0.005234 },
            { 1.964, 0.02704, 0.07224, 0.07567, -0.02372, -4.435, 0.7187, 0.5652, -1.641, 2.491, -0.5739, -4.864, 0.3722, -0.5066, -0.3793, 0.4396, -1.708, -0.3218, -1.561, -3.924, 0.1258, -0.01293, -1.063, 0.5066, 1.021, -0.03066, 0.04146, -0.1392, 0.2818, 0.1921 },
            { -3.651, -0.1232, 0.2943, -0.4105, 0.01056, 2.663, -0.08612, -0.1102, -1.754, 1.748, 1.311, -4.377, -0.7073, -0.2537, 0.0956, 0.02884, -1.59, 2.41, -1.748, 3.479, 0.02997, -0.08962, -0.8549, 0.1602, 0.09998, -0.002912, -0.01734, -0.2356, 0.08521, 0.02845 },
            { -4.839, -0.1477, 0.5494, -0.3778, 0.07282, 4.457, 1.015, 0.4246, -4.389, -2.261, 0.7052, 1.473, 0.5057, 0.2173, 0.4408, 0.7103, -9.438, -0.3681, -0.8075, -3.254, -0.08517, -0.1417, 0.2262, -0.7374, 0.3832, 0.008449, 0.004974, -0.09693, 0.1812, 0.1695 },
            { 1.558, -0.04516, -1.399, 0.1707, 0.0153, -0.646, -0.05832, -0.1396, 2.747, 2.137, -0.7593, 1.368, -2.339, 0.1428, 0.4223, -0.317, 3.149, 2.955, 0.3585, -2.558, -0.004752, -0.05694, -0.0181, 0.05547, 0.3889, -0.008604, 0.002216, -0.002981, 0.04747, 0.03388 },
            { 0.3047, 0.0651, -0.2866, 0.01814, -0.006861, -1.298, -0.1636, -0.0166, 1.692, -0.03597, -0.5265, 2.322, -1.314, 0.1029, -0.1928, -1.098, 3.819, 4.107, 1.157, -2.571, -0.1371, -0.09623, 1.141, -0.3151, 0.5595, -0.00484, 0.02498, 0.1125, -0.09515, 0.003432 } },
          { -1.73, -1.723, 1.467, 1.712, -1.225, -1.266, -1.49 } },
	.region_sigma = 0.03, .region_shape_sigma = 0.02, .region_hidden = 1.2, .strip_sigma = 0.005, .strip_conf = { 6, 30, 100 }, .max_gross = 0.1, .sure_gross = 0.03, .max_rms = 0.008,
	.hint_sigma = 0.08, .drawn_sigma = 0.01, .max_over = 0.6, .min_level = 0.04,
};

/* Tests run in the repository; tools that run elsewhere find no eyes. */
__attribute__((constructor))
static void limbus_defaults_open(void)
{
	struct err err = { 0 };
	evidence_open(&limbus_defaults.net, "config/evidence.onnx", &err);
	strip_open(&limbus_defaults.strip, "config/strip.onnx", &err);
}

static const struct pose_conf pose_defaults = {
	.pupil_offset_sigma = 0.15, .depth_sigma = 0.25, .pupil_floor = 0.012, .aspect_mean = 1, .aspect_sigma = 0,
};

#endif
