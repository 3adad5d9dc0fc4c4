/* The defaults of config/transfer.conf, for tests and benchmarks that call the library. */
#ifndef TESTS_TRANSFER_CONF_H
#define TESTS_TRANSFER_CONF_H
#include "register/transfer.h"
#include "register/transfer_check.h"

static const struct transfer_conf transfer_defaults = {
	.nricp = { .nodes = { 300, 2500, 12000 }, .rounds = { 4, 4, 2 }, .stiff = { 0.2, 0.016 }, .noise = 2.7, .rigid = 0.06, .growth = 0.6,
	           .turn = 0.07, .slide = 0.002, .welsch = { 0.1, 0.075 }, .facing = 0.5, .rim = 1, .rim_slide = 0,
	           .rim_reach = 0.1, .mirror = 0.003, .polish_rounds = 2, .polish = 0.005, .polish_noise = 6.5 },
	.align = { .samples = 400, .rounds = 12, .welsch = { 0.5, 0.1 }, .turn = 0.07, .facing = 0.3, .scale_max = 2, .fine = 0.05, .margin = 1.5, .good = 0.5,
	           .least = 0.3, .starts = 60 },
	.below_eyes = 0.6, .nearly = 0.9, .least_piece = 0.1, .open = 0.12, .snap = 0.05,
};

static const struct transfer_check_conf transfer_check_defaults = {
	.covered = 0.3, .flipped = 0.001, .stretch = 0.5, .eyes = 0.3, .landmarks = 0.3,
};

#endif
