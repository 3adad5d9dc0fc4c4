/* Whatever the picture: limbus_find comes back, says why not or gives finite numbers; and what it accepts among the
 * synthetic eyes is right. --cases=N is not needed: `make stress` runs a fixed, seeded set. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "math/rng.h"
#include "tests/lib/limbus_conf.h"
#include "tests/lib/synth_eye.h"

enum { CASES = 48 };

/* A synthetic eye pushed to where it may no longer be one: cut, closed, tiny, flat, burnt, black, grey, upside down. */
static struct photo strange(int index, struct rng *rng, struct synth_truth *truth, bool *fair)
{
	struct synth_eye eye = synth_eye_grid(rng_below(rng, SYNTH_GRID));
	const int kind = index % 8;
	*fair = kind == 0;
	eye.seed = rng_bits(rng);
	eye.width = 160 + rng_below(rng, 700);
	eye.height = 120 + rng_below(rng, 700);
	eye.limbus_px = rng_range(rng, 0.03, kind == 1 ? 0.9 : 0.45) * fmin(eye.width, eye.height);
	eye.center[0] = rng_range(rng, kind == 1 ? 0 : 0.35, kind == 1 ? 1 : 0.65) * eye.width;
	eye.center[1] = rng_range(rng, kind == 1 ? 0 : 0.35, kind == 1 ? 1 : 0.65) * eye.height;
	eye.occlusion = kind == 2 ? rng_range(rng, 0.6, 0.85) : rng_range(rng, 0, 0.3);
	eye.exposure *= kind == 3 ? rng_range(rng, 2, 30) : kind == 4 ? rng_range(rng, 0.001, 0.1) : 1;
	eye.blur = kind == 5 ? rng_range(rng, 5, 20) : eye.blur;
	eye.noise = kind == 6 ? rng_range(rng, 0.1, 0.6) : eye.noise;
	eye.lids = kind != 7;
	if (*fair) {
		eye.limbus_px = fmax(eye.limbus_px, 45);
		eye.center[0] = fmin(fmax(eye.center[0], 1.1 * eye.limbus_px), eye.width - 1.1 * eye.limbus_px);
		eye.center[1] = fmin(fmax(eye.center[1], 1.1 * eye.limbus_px), eye.height - 1.1 * eye.limbus_px);
	}
	return synth_eye_render(&eye, truth);
}

int main(void)
{
	struct rng rng = { 99 };
	struct limbus_found *found = mem_new(1, sizeof *found);
	int accepted = 0, wrong = 0, fair_n = 0, fair_found = 0, broken = 0;
	for (int i = 0; i < CASES; i++) {
		struct synth_truth truth;
		bool fair;
		struct photo photo = strange(i, &rng, &truth, &fair);
		limbus_find(found, &photo, 0, &limbus_defaults);
		const struct ellipse *e = &found->limbus.e, *t = &truth.limbus;
		double error = fmax(hypot(e->cx - t->cx, e->cy - t->cy), fmax(fabs(e->a - t->a), fabs(e->b - t->b))) / t->a;
		if (found->ok) {
			accepted++;
			wrong += error > 0.05;
			broken += !isfinite(e->cx + e->cy + e->a + e->b + e->angle + found->limbus.cov_q[0][0]);
		} else {
			broken += !found->reason[0];
		}
		fair_n += fair;
		fair_found += fair && found->ok && error < 0.05;
		photo_free(&photo);
	}
	free(found);
	printf("limbus: %d pictures, %d accepted, %d of those off by more than 5 %%; of %d fair ones %d found; %d broken answers\n",
	       CASES, accepted, wrong, fair_n, fair_found, broken);
	return broken != 0;
}
