/* Whatever the picture: limbus_find comes back, says why not or gives finite numbers; an eye that is there to be seen is found
 * where it is. Flagged: rejected. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "tests/lib/conf/limbus_conf.h"
#include "tests/lib/stress.h"
#include "tests/lib/scenes/synth_eye.h"

enum kind { FAIR, ASIDE, CLOSED, BURNT, DARK, BLURRED, NOISY, NO_LIDS, KINDS };
static const char *const kinds[] = { "fair", "cut by the frame", "nearly closed", "over-exposed", "dark", "blurred", "noisy", "without lids" };

/* A synthetic eye pushed to where it may no longer be one. */
static struct photo strange(enum kind kind, struct rng *rng, struct synth_truth *truth)
{
	struct synth_eye eye = synth_eye_grid(rng_below(rng, SYNTH_GRID));
	eye.seed = rng_bits(rng);
	eye.width = 160 + rng_below(rng, 700);
	eye.height = 120 + rng_below(rng, 700);
	eye.limbus_px = rng_range(rng, 0.03, kind == ASIDE ? 0.9 : 0.45) * fmin(eye.width, eye.height);
	eye.center[0] = rng_range(rng, kind == ASIDE ? 0 : 0.35, kind == ASIDE ? 1 : 0.65) * eye.width;
	eye.center[1] = rng_range(rng, kind == ASIDE ? 0 : 0.35, kind == ASIDE ? 1 : 0.65) * eye.height;
	eye.occlusion = kind == CLOSED ? rng_range(rng, 0.6, 0.85) : rng_range(rng, 0, 0.3);
	eye.exposure *= kind == BURNT ? rng_range(rng, 2, 30) : kind == DARK ? rng_range(rng, 0.001, 0.1) : 1;
	eye.blur = kind == BLURRED ? rng_range(rng, 5, 20) : eye.blur;
	eye.noise = kind == NOISY ? rng_range(rng, 0.1, 0.6) : eye.noise;
	eye.lids = kind != NO_LIDS;
	if (kind == FAIR) {
		eye.limbus_px = fmax(eye.limbus_px, 45);
		eye.center[0] = fmin(fmax(eye.center[0], 1.1 * eye.limbus_px), eye.width - 1.1 * eye.limbus_px);
		eye.center[1] = fmin(fmax(eye.center[1], 1.1 * eye.limbus_px), eye.height - 1.1 * eye.limbus_px);
	}
	return synth_eye_render(&eye, truth);
}

static void one(struct stress *s, struct limbus_found *found, enum kind kind)
{
	struct synth_truth truth;
	struct photo photo = strange(kind, &s->rng, &truth);
	const struct ellipse *t = &truth.limbus, *e = &found->limbus.e;
	stress_about(s, "%s, %d x %d, limbus %.0f %.0f, %.0f px", kinds[kind], photo.width, photo.height, t->cx, t->cy, t->a);
	limbus_find(found, &photo, 0, &limbus_defaults);
	if (!found->ok) {
		stress_flagged(s);
		if (!found->reason[0])
			stress_wrong(s, "rejected without a reason");
	} else if (!isfinite(e->cx + e->cy + e->a + e->b + e->angle + found->limbus.cov_q[0][0])) {
		stress_wrong(s, "accepted, and not numbers");
	} else {
		double off = fmax(hypot(e->cx - t->cx, e->cy - t->cy), fmax(fabs(e->a - t->a), fabs(e->b - t->b))) / t->a;
		stress_measure(s, off, "of a from the limbus, of those accepted");
		if (kind == FAIR && off > 0.05)
			stress_wrong(s, "accepted %.2g of a from the limbus", off);
	}
	photo_free(&photo);
}

int main(int argc, char **argv)
{
	struct stress s;
	struct limbus_found *found = mem_new(1, sizeof *found);
	stress_start(&s, "limbus", argc, argv);
	for (enum kind kind = 0; kind < KINDS; kind++)
		for (stress_family(&s, kinds[kind], kind == FAIR ? 24 : 6); stress_case(&s);)
			one(&s, found, kind);
	free(found);
	return stress_end(&s);
}
