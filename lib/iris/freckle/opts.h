/* freckle_opts: rows for the option table of freckles. */
#ifndef IRIS_FRECKLE_OPTS_H
#define IRIS_FRECKLE_OPTS_H
#include "base/opt.h"
#include "iris/freckle/freckle.h"

/* c: struct freckle_conf *. */
#define FRECKLE_OPTS(c) \
	OPT_INT("max_size", &(c)->max_size, 64, 8192, "texels", "a side of the map searched, at most"), \
	OPT_REAL("blur", &(c)->blur, 0, 0.2, "mm", "before colours are compared"), \
	OPT_REAL("ratio", &(c)->ratio, 0.05, 3, "", "least rise of log(red / green)"), \
	OPT_REAL("ratio_z", &(c)->ratio_z, 0, 50, "sigma", "least rise in the spread of the surroundings"), \
	OPT_REAL("darker", &(c)->darker, 0, 3, "", "least fall of log(green)"), \
	OPT_REAL("red_share", &(c)->red_share, 0, 1, "", "most that red falls, as a share of green"), \
	OPT_REAL("edge", &(c)->edge, 0.1, 0.9, "", "share of its own level at which a spot ends"), \
	OPT_REAL("min_area", &(c)->min_area, 0, 1, "mm2", "smallest spot"), \
	OPT_REAL("brown", &(c)->brown, -2, 5, "", "log(red / green) from which an iris is brown"), \
	OPT_REAL("flat_area", &(c)->flat_area, 0, 10, "mm2", "smallest spot of a brown iris"), \
	OPT_REAL("flat_spread", &(c)->flat_spread, 0, 5, "", "most spread inside, as a share of that around"), \
	OPT_REAL("flat_darker", &(c)->flat_darker, 0, 3, "", "least fall of log(green) in a brown iris"), \
	OPT_REAL("flat_long", &(c)->flat_long, 1, 10, "", "most length over width in a brown iris"), \
	OPT_REAL("limbus_margin", &(c)->limbus_margin, 0, 3, "mm", "iris next to the limbus left out"), \
	OPT_REAL("search_deg", &(c)->search_deg, 10, 180, "deg", "round the iris for a pattern"), \
	OPT_REAL("band", &(c)->band, 0.02, 2, "mm", "surroundings that a pattern has to continue"), \
	OPT_INT("candidates", &(c)->candidates, 1, 1000, "", "patterns tried on either side")

#endif
