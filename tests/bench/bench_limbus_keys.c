/* What the constants of config/limbus.conf are worth: each key of the search and the measurement halved and made half as large again, the others
 * as they are; how many unseen eyes are then right, wrong but ok, refused, and how far off the right ones are. A key that changes nothing
 * is none; one on which all hangs is a weakness. SEED (1000 where not set: not the one that judges), CASES.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "math/stats.h"
#include "tests/lib/bench/bench.h"
#include "tests/lib/unseen/answer.h"
#include "tests/lib/unseen/crew.h"

struct key { const char *name; double *at, was; };
struct result { bool ok; double error; };
struct eyes { uint64_t seed; int n_keys, n; struct key key[64]; struct result *result; };

static void add(struct eyes *s, const char *name, double *at)
{
	s->key[s->n_keys++] = (struct key){ .name = name, .at = at, .was = *at };
}

static void list(struct eyes *s)
{
	struct limbus_conf *c = answer_conf();
	add(s, "as shipped", &c->max_over);
	add(s, "seek_contrast", &c->seek.contrast);
	add(s, "search", &c->rim.search);
	add(s, "measured_px", &c->rim.max_axis);
	add(s, "arc_rms", &c->rim.max_rms);
	add(s, "arc_contrast", &c->rim.min_contrast);
	add(s, "irregularity", &c->rim.irregularity);
	add(s, "straying", &c->rim.straying);
	add(s, "coarse_straying", &c->rim.coarse_straying);
	add(s, "colour_gain", &c->rim.colour_gain);
	add(s, "rough_gain", &c->rim.rough_gain);
	add(s, "pupil_contrast", &c->pupil.min_contrast);
	add(s, "pupil_coverage", &c->pupil.min_coverage);
	add(s, "pupil_first_contrast", &c->pupil.first_contrast);
	add(s, "pupil_first_score", &c->pupil.first_score);
	add(s, "pupil_window", &c->pupil.least_window);
	add(s, "pupil_told_sigma, limbus", &c->pupil.told_sigma[0]);
	add(s, "pupil_told_sigma, pupil", &c->pupil.told_sigma[1]);
	add(s, "pupil_told_sure", &c->pupil.told_sure);
	add(s, "pupil_told_within", &c->pupil.told_within);
	add(s, "pupil_told_apart", &c->pupil.told_apart);
	add(s, "pupil_told_used", &c->pupil.told_used);
	add(s, "rough_px", &c->trial.limbus_px);
	add(s, "rough_pupil_px", &c->trial.pupil_px);
	add(s, "window_place", &c->trial.window_place);
	add(s, "window_size", &c->trial.window_size);
	add(s, "window_again", &c->trial.window_again);
	add(s, "least_region", &c->trial.least_region);
	add(s, "start_alike", &c->trial.start_alike);
	add(s, "prior_arcs", &c->trial.prior_arcs);
	add(s, "strip_arcs", &c->trial.strip_arcs);
	add(s, "same_sigmas", &c->same.sigmas);
	add(s, "same_most", &c->same.most);
	add(s, "same_unseen", &c->same.unseen);
	add(s, "other_eye", &c->same.other_eye);
	add(s, "moved_gross", &c->same.moved);
	add(s, "strip_rays", &c->strip_conf.rays);
	add(s, "strip_hidden", &c->strip_conf.hidden);
	add(s, "strip_pixels", &c->strip_conf.pixels);
	add(s, "strip_least", &c->strip_conf.least);
	add(s, "strip_seen", &c->strip_conf.seen);
	add(s, "strip_noise", &c->strip_conf.noise);
	add(s, "strip_near", &c->strip_conf.near);
	add(s, "strip_reach, size", &c->strip_conf.reach[0]);
	add(s, "strip_reach, centre", &c->strip_conf.reach[1]);
	add(s, "strip_start_sigma, centre", &c->strip_conf.start_sigma[0]);
	add(s, "strip_start_sigma, shape", &c->strip_conf.start_sigma[1]);
	add(s, "strip_sigma", &c->strip_sigma);
	add(s, "region_sigma", &c->region_sigma);
	add(s, "region_shape_sigma", &c->region_shape_sigma);
	add(s, "region_hidden", &c->region_hidden);
	add(s, "tolerance", &c->tolerance);
	add(s, "max_gross", &c->max_gross);
	add(s, "sure_gross", &c->sure_gross);
}

enum { WAYS = 2 };
static const double factor[WAYS] = { 0.5, 1.5 };

/* Case i: photograph i / (keys x ways) under one change. */
static void one(void *ctx, int i)
{
	const struct eyes *s = ctx;
	const struct key *key = &s->key[i / WAYS % s->n_keys];
	struct unseen u = unseen_make(s->seed, i / WAYS / s->n_keys);
	struct answer got;
	*key->at = key == s->key ? key->was : factor[i % WAYS] * key->was;
	answer_ours(&got, &u.photo, u.aspect);
	*key->at = key->was;
	const struct unseen_eye *meant = got.ok ? answer_meant(&got.e, &u) : 0;
	s->result[i] = (struct result){ got.ok, got.ok ? ellipse_apart(&got.e, &meant->limbus) / meant->limbus.a : NAN };
	unseen_free(&u);
}

int main(int argc, char **argv)
{
	bench_open("limbus_keys", argc, argv);
	const char *seed = getenv("SEED"), *cases = getenv("CASES");
	struct eyes s = { .seed = seed ? strtoull(seed, 0, 10) : 1000, .n = cases ? atoi(cases) : bench_quick() ? 6 : 60 };
	list(&s);
	const int all = s.n * s.n_keys * WAYS;
	s.result = crew_array((size_t)all, sizeof *s.result);
	crew_run(all, one, &s);
	double *off = mem_array((size_t)s.n, sizeof *off);
	for (int k = 0; k < s.n_keys; k++)
		for (int way = 0; way < (k ? WAYS : 1); way++) {
			int right = 0, wrong = 0;
			for (int i = 0; i < s.n; i++) {
				const struct result *r = &s.result[(i * s.n_keys + k) * WAYS + way];
				if (r->ok && r->error <= answer_right())
					off[right++] = r->error;
				wrong += r->ok && !(r->error <= answer_right());
			}
			char *setting = mem_printf("%s%s: %d right, %d wrong but ok, %d refused", s.key[k].name, !k ? "" : way ? " x 1.5" : " x 0.5", right, wrong, s.n - right - wrong);
			bench_row("keys of the limbus", "ours", setting, (struct bench_time){ NAN, NAN, NAN }, "photograph", right ? 100 * stats_median(right, off) : NAN, "%",
			          "of the semi-axis, median of right ones");
			free(setting);
		}
	free(off);
	return bench_close();
}
