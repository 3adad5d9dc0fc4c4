#include "tissue/rounds.h"

#include <math.h>
#include <string.h>

/* One round: classes, pigment, and the relief that follows. next: thickness after the filter. */
static bool turn(struct tissue_rounds *out, struct image *next, const struct image *thickness, const struct tissue_maps *m,
                 const struct tissue_rounds_conf *c, struct err *err)
{
	struct relief_fit relief;
	struct pigment_fit first = out->fit;
	if (!pigment_classify(&out->classes, m->clean, thickness, m->extent, m->pupil, m->root, m->white, &c->classes, err)
	    || !pigment_solve(&out->fit, &out->classes, &c->pigment, out->n ? first.x : 0, err)
	    || !relief_solve(&relief, m->clean, m->thickness, m->extent, m->pupil, m->root, m->white, out->fit.x, &c->pigment, &c->relief, err))
		return false;
	if (out->n) {  // what the several starts of the first round found stays said
		out->fit.starts = first.starts;
		out->fit.minima = first.minima;
		memcpy(out->fit.other, first.other, sizeof first.other);
	}
	out->residual[out->n] = out->fit.residual;
	out->relief[out->n++] = relief.after;
	return relief_apply(next, m->thickness, m->extent, &relief, &c->relief, err);
}

bool tissue_rounds(struct tissue_rounds *out, const struct tissue_maps *maps, const struct tissue_rounds_conf *c, struct stage *stage,
                   struct err *err)
{
	struct image thickness = { 0 };
	bool ok = true, pays = true;
	*out = (struct tissue_rounds){ 0 };
	while (ok && pays && out->n < c->most && out->n < TISSUE_ROUNDS_MAX) {
		struct image next = { 0 };
		ok = turn(out, &next, thickness.px ? &thickness : maps->thickness, maps, c, err);
		image_free(&thickness);
		thickness = next;
		int r = out->n;
		double before = r > 1 ? out->residual[r - 2] + out->relief[r - 2] : INFINITY, now = ok ? out->residual[r - 1] + out->relief[r - 1] : 0;
		pays = now < (1 - c->gain_min) * before;
		stage_progress(stage, r, c->most, "pigment and relief");
	}
	image_free(&thickness);
	return ok;
}
