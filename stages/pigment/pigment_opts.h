/* pigment_opts: the stage's own option rows. */
#ifndef STAGES_PIGMENT_OPTS_H
#define STAGES_PIGMENT_OPTS_H
#include "stages/pigment/pigment_stage.h"

/* c: struct pigment_stage_conf */
#define PIGMENT_OPTS(c) \
	OPT_CHOICE("scattering", &(c)->order, pigment_orders, "orders of scattering"), \
	OPT_INT("bands", &(c)->fit.bands, 3, TISSUE_BANDS_MAX, "", "wavelengths"), \
	OPT_INT("starts", &(c)->fit.starts, 1, 64, "", "places the fit starts from"), \
	OPT_REAL("light_error", &(c)->fit.light_error, 0.001, 3, "", "error of a class' ln light"), \
	OPT_REAL("model_error", &(c)->fit.model_error, 0.001, 1, "", "error of a class' ln colour"), \
	OPT_REAL("floor", &(c)->fit.floor, 0, 0.1, "", "absolute error of reflectance"), \
	OPT_REAL("abl_mm", &(c)->fit.abl_thickness, 0.001, 0.2, "mm", "thickness of the anterior border layer"), \
	OPT_REALS("prior_abl_melanin", (c)->prior_melanin[0], 2, 1e-5, 10, "", "median, sigma of ln"), \
	OPT_REALS("prior_abl_ratio", (c)->prior_ratio[0], 2, 0, 1, "", "mean, sigma"), \
	OPT_REALS("prior_stroma_melanin", (c)->prior_melanin[1], 2, 1e-5, 10, "", "median, sigma of ln"), \
	OPT_REALS("prior_stroma_ratio", (c)->prior_ratio[1], 2, 0, 1, "", "mean, sigma"), \
	OPT_REAL("profile_error", &(c)->fit.profile_error, 0.001, 2, "", "error of ln thickness of the whole profile"), \
	OPT_REAL("ring_error", &(c)->fit.ring_error, 0.001, 2, "", "of each ring"), \
	OPT_CHOICE("melanin", &(c)->melanin, pigment_melanins, "of the border layer: one number for the iris (the paper's), or a map"), \
	OPT_REAL("melanin_ring", &(c)->melanin_ring, 0.01, 5, "", "map: rms of ln melanin between rings"), \
	OPT_REAL("melanin_field", &(c)->map.field, 0.01, 5, "", "map: rms of ln melanin about the rings'"), \
	OPT_REAL("melanin_reach_mm", &(c)->map.reach, 0.1, 10, "mm", "map: distance over which that is alike"), \
	OPT_REAL("melanin_cell_mm", &(c)->map.cell, 0.3, 3, "mm", "map: pitch of its nodes"), \
	OPT_REALS("prior_spread", (c)->prior_spread, 2, 0.001, 3, "", "rms of ln thickness in a ring: median, sigma of ln"), \
	OPT_REALS("prior_scale", (c)->prior_scale, 2, 0.01, 10, "", "median, sigma of ln"), \
	OPT_REALS("prior_exposure", (c)->prior_exposure, 2, 0.01, 10, "", "median, sigma of ln"), \
	OPT_REAL("light_unknown", &(c)->light_unknown, 0.001, 3, "", "sigma of ln exposure where no light.environment is given"), \
	OPT_REALS("prior_exposure_single", (c)->prior_exposure_single, 2, 0.01, 10, "", "the same for single scattering"), \
	OPT_REAL("prior_white", &(c)->prior_white, 0.001, 1, "", "sigma of ln red and blue of the white"), \
	OPT_REAL("prior_veil", &(c)->prior_veil, 1e-4, 1, "", "sigma of the cornea's reflection"), \
	OPT_CHOICE("white", &(c)->white_from, pigment_whites, "where white is taken from"), \
	OPT_REAL("white_unknown", &(c)->white_unknown, 0.01, 5, "", "sigma of ln exposure where no white was seen"), \
	OPT_REAL("white_doubt", &(c)->white_doubt, 0, 10, "", "ln: errors of the white as fitted that are smaller are the model's"), \
	OPT_REAL("card_reflectance", &(c)->white.card, 0.01, 1, "", "of the grey card"), \
	OPT_REALS("sclera", (c)->white.sclera, 3, 0.05, 1, "", "reflectance of the sclera: R G B"), \
	OPT_REAL("sclera_inner", &(c)->white.pale.inner, 1, 2, "", "ring searched for sclera, in limbus semi-axes"), \
	OPT_REAL("sclera_outer", &(c)->white.pale.outer, 1.05, 3, "", "the same, outer"), \
	OPT_REAL("sclera_redness", &(c)->white.pale.redness, 0.01, 2, "", "ln R/G above the palest that is skin"), \
	OPT_REAL("sclera_reddest", &(c)->white.pale.reddest, 0.05, 3, "", "ln R/G that is skin in any light"), \
	OPT_REAL("sclera_dark", &(c)->white.pale.dark, 0, 1, "", "share of the brightest that is shadow"), \
	OPT_REAL("sclera_shade", &(c)->white.shade_most, 0, 3, "", "ln by which the light on sclera and iris may differ"), \
	OPT_REAL("sclera_sure", &(c)->white.pale.sure, 0, 1, "", "evidence from which a place counts as sclera"), \
	OPT_REAL("sclera_share_min", &(c)->white.share_min, 0.001, 1, "", "less of the ring than that is no white"), \
	OPT_REAL("white_sigma", &(c)->fellow.sigma, 0.001, 1, "", "of ln R/G, ln B/G of a white, beside the other eye's"), \
	OPT_REALS("white_skin", (c)->fellow.skin, 2, 0.001, 0.99, "", "chance that skin is in a white, ln R/G that it adds"), \
	OPT_REAL("white_light", &(c)->fellow.light, 0.001, 1, "", "scale by which light differs at both eyes"), \
	OPT_REAL("white_iris", &(c)->fellow.iris, 0.001, 1, "", "scale by which both irises differ"), \
	OPT_REALS("white_iris_ring", (c)->fellow.ring, 2, 0, 1, "", "part of the irises that is compared"), \
	OPT_INT("rings", &(c)->classes.rings, 1, 8, "", "classes of radius"), \
	OPT_INT("levels", &(c)->classes.levels, 1, 8, "", "classes of light in each"), \
	OPT_REAL("inner", &(c)->classes.inner, 0, 1, "", "tissue is trusted from here: share of the way to the root"), \
	OPT_REAL("outer", &(c)->classes.outer, 0, 1, "", "to here"), \
	OPT_REAL("grain_mm", &(c)->classes.grain, 0.005, 1, "mm", "size of an independent patch")

#endif
