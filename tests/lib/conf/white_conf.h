/* The defaults of config/pigment.conf about white, for tests and benchmarks that call the library. */
#ifndef TESTS_WHITE_CONF_H
#define TESTS_WHITE_CONF_H
#include "tissue/pigment/white.h"
#include "tissue/pigment/white_pair.h"

static const struct white_conf white_defaults = {
	.pale = { .inner = 1.1, .outer = 1.5, .redness = 0.2, .reddest = 0.45, .dark = 0.3, .sure = 0.6 }, .sclera = { 0.66, 0.55, 0.48 }, .share_min = 0.03, .card = 0.18, .shade_most = 0.2,
};

static const struct white_pair_conf white_pair_defaults = {
	.sigma = 0.04, .skin = { 0.3, 0.2 }, .light = 0.1, .iris = 0.1, .ring = { 0.5, 0.8 },
};

#endif
