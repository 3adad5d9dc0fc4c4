/* unrefract_opts: rows for the option table of unrefract. */
#ifndef IRIS_UNREFRACT_OPTS_H
#define IRIS_UNREFRACT_OPTS_H
#include "anatomy/keys.h"
#include "base/opt.h"
#include "iris/unrefract/unrefract.h"

/* enum iris_method, in its order. */
static const char *const unrefract_methods[] = { "lattice", "newton", "algorithm1", 0 };

/* c: struct unrefract_conf *. */
#define UNREFRACT_OPTS(c) \
	LIGHT_POLARISED_OPT(&(c)->polarised), \
	OPT_CHOICE("method", &(c)->map.method, unrefract_methods, "how texels find their photo pixels"), \
	OPT_INT("node", &(c)->map.node, 2, 64, "texels", "between the nodes of the lattice"), \
	OPT_REAL("alpha", &(c)->map.alpha, 1e-3, 10, "mm", "first step of algorithm 1"), \
	OPT_REAL("eps_inner", &(c)->map.eps_inner, 0, 1, "mm", "algorithm 1: step at which a plane is done"), \
	OPT_REAL("eps_outer", &(c)->map.eps_outer, 0, 1, "mm", "algorithm 1: distance at which the planes are done"), \
	OPT_INT("max_inner", &(c)->map.max_inner, 1, 1000000, "", "algorithm 1: steps on a plane"), \
	OPT_INT("max_outer", &(c)->map.max_outer, 1, 100000, "", "algorithm 1: planes"), \
	OPT_REAL("scale", &(c)->scale, 0.1, 4, "", "texels for a photo pixel"), \
	OPT_INT("max_size", &(c)->max_size, 64, 8192, "texels", "a side, at most"), \
	OPT_REAL("extent", &(c)->extent, 1, 1.5, "", "half-width of the maps over the limbus radius"), \
	OPT_INT("survey_size", &(c)->survey_size, 64, 2048, "texels", "a side of the survey"), \
	OPT_REAL("limbus_haze", &(c)->haze, 0.001, 0.5, "", "share of the iris' own light that the sclera's may add beside the limbus"), \
	OPT_REAL("pupil_told", &(c)->pupil_told, 0, 1000, "", "what log odds of being pupil all over an iris are worth"), \
	OPT_REAL("pupil_missed", &(c)->pupil_missed, -5, 5, "", "log odds of being pupil that the network leaves out"), \
	OPT_REAL("pupil_step", &(c)->pupil_step, 0, 100, "", "what a step of log brightness at a pupil's margin is worth"), \
	OPT_REALS("pupil_usual", (c)->pupil_usual, 2, 0.01, 5, "", "radius of pupils in mm and sigma of its logarithm"), \
	OPT_REAL("pupil_fellow", &(c)->pupil_fellow, 0.005, 1, "", "sigma of the logarithm of both eyes' ratio"), \
	OPT_REAL("pupil_margin", &(c)->pupil_margin, 0, 0.5, "mm", "over which the pupil's margin fades"), \
	OPT_REAL("limbus_ramp", &(c)->limbus_ramp, 0, 2, "mm", "over which the weight falls at the limbus"), \
	OPT_REAL("lid_z", &(c)->lid_z, 0.5, 10, "sigma", "outlier level of lids"), \
	OPT_REAL("lid_told", &(c)->lid_told, 0, 10, "", "weight of what the network tells of lids"), \
	OPT_REAL("lid_shadow", &(c)->lid_shadow, 0, 5, "", "log contrast of the shadow beside a lid"), \
	OPT_REAL("lid_shade", &(c)->lid_shade, 0, 4, "mm", "how far a lid takes light from the iris"), \
	OPT_REAL("lid_smooth", &(c)->lid_smooth, 0, 100, "", "stiffness of the lid's edge"), \
	OPT_REAL("glint_z", &(c)->glint_z, 0.5, 20, "sigma", "outlier level of reflections"), \
	OPT_REAL("glint_grow", &(c)->glint_grow, 0, 1, "mm", "margin round reflections"), \
	OPT_REAL("saturated", &(c)->saturated, 0.1, 1, "", "share of full scale that is saturated"), \
	OPT_REAL("lash_contrast", &(c)->lash_contrast, 0.1, 5, "", "log contrast of lashes"), \
	OPT_REAL("lash_width", &(c)->lash_width, 0.02, 0.5, "mm", "width of lashes"), \
	OPT_REAL("foreshortening", &(c)->foreshortening, 0, 8, "", "exponent of a foreshortened texel's weight"), \
	OPT_REAL("torsion_max_deg", &(c)->torsion_max_deg, 0, 180, "deg", "turn searched between photographs"), \
	OPT_REAL("correlation_min", &(c)->correlation_min, -1, 1, "", "photographs that agree less are left out")

#endif
