/* balance_opts: rows for the option table of the program that looks for the light's colour. */
#ifndef IRIS_BALANCE_OPTS_H
#define IRIS_BALANCE_OPTS_H
#include "base/opt.h"
#include "iris/balance.h"

/* c: struct balance_conf *. */
#define BALANCE_OPTS(c) \
	OPT_REALS("sclera", (c)->sclera, 3, 0.05, 1, "", "reflectance of the sclera: R G B"), \
	OPT_REAL("sclera_inner", &(c)->inner, 1, 2, "", "ring looked at for sclera, in limbus semi-axes"), \
	OPT_REAL("sclera_outer", &(c)->outer, 1.05, 3, "", "the same, outer"), \
	OPT_REAL("sclera_dark", &(c)->dark, 0, 1, "", "share of the brightest that is shadow"), \
	OPT_REAL("sclera_share_min", &(c)->share_min, 0.001, 1, "", "less of the ring than that is no white")

/* Checks what ranges of single options cannot. Returns false, err set. */
static inline bool balance_conf_check(const struct balance_conf *c, struct err *err)
{
	return c->outer > c->inner
	       || err_set(err, "unrefract.sclera_outer = %g: must be above unrefract.sclera_inner = %g", c->outer, c->inner);
}

#endif
