/* Training: a clip of known maps gives them back; noise, gaps, lost frames, half a face; rendered clips. */
#include "model/train/train.h"

#include <omp.h>

#include "base/mem.h"
#include "math/rng.h"
#include "tests/lib/bench/bench.h"
#include "tests/lib/scenes/linear_clip.h"
#include "tests/lib/scratch.h"
#include "tests/lib/truth/tracked.h"
#include "tests/lib/unit.h"

static const struct linear_clip_conf usual = { .n = 900, .n_points = 17, .n_vertices = 60, .n_au = 2, .fps = 60, .scale = 1,
	                                           .seed = 1 };

struct trained {
	struct linear_clip *clip;
	struct skin_model model;
	struct train_report report;
	struct err err;
	bool ok;
};

static struct trained train(const struct linear_clip_conf *f, const struct train_conf *conf)
{
	struct trained t = { .clip = linear_clip_new(f) };
	struct train_clip clip = linear_clip_train(t.clip);
	struct train_conf brief = *conf;
	brief.brief = true;
	t.ok = train_run(&t.model, &t.report, &clip, &brief, &t.err);
	return t;
}

static void trained_free(struct trained *t)
{
	linear_clip_free(t->clip);
	skin_model_free(&t->model);
	train_report_free(&t->report);
}

/* Largest difference of predicted skin and lids from the truth over inputs that the clip did not hold; *rms. */
static double held_out(const struct trained *t, double *rms)
{
	const struct linear_clip_conf *f = &t->clip->conf;
	int n_lid = t->model.n_lid, nu = 2 * f->n_vertices, n = 0;
	double *l = mem_new((size_t)n_lid, sizeof *l), *u = mem_new((size_t)nu, sizeof *u), worst = 0, sum = 0;
	double *l1 = mem_new((size_t)n_lid, sizeof *l1), *u1 = mem_new((size_t)nu, sizeof *u1), g[14], c[14];
	struct rng rng = { 77 };
	for (int i = 0; i < 50; i++) {
		for (int k = 0; k < SKIN_EYE_INPUTS + f->n_au; k++) {
			double x = rng_uniform(&rng);
			g[k] = k >= SKIN_EYE_INPUTS ? x : k % 5 == 2 ? 2 * x - 1 : k % 5 < 2 ? 40 * x - 20 : f->scale * (10 + 25 * x);
			if (k >= 5 && k < 10)  // eyes move together, nearly
				g[k] = f->no_right ? 0 : g[k - 5] * (0.95 + 0.1 * x);
		}
		linear_clip_truth(l, u, t->clip, g);
		skin_model_controls(c, &t->model, g);
		skin_model_predict(u1, l1, &t->model, c);
		for (int k = 0; k < n_lid / (f->no_right ? 2 : 1); k++)
			worst = fmax(worst, fabs(l[k] - l1[k]));
		for (int k = 0; k < nu; k++, n++) {
			worst = fmax(worst, fabs(u[k] - u1[k]));
			sum += (u[k] - u1[k]) * (u[k] - u1[k]);
		}
	}
	free(l);
	free(u);
	free(l1);
	free(u1);
	*rms = sqrt(sum / n);
	return worst;
}

/* Without noise, the chain gaze -> lids -> skin is linear of rank 4: nothing may be lost but rounding. */
static void known_maps(void **state)
{
	(void)state;
	struct trained t = train(&usual, &train_defaults);
	double rms, worst = held_out(&t, &rms);
	assert_true(t.ok);
	NEAR(worst, 0, 1e-6);  // maps amplify 1e-10 (dropped directions) by inputs of some 100
	assert_int_equal(t.report.rank[TRAIN_LEFT], 5);
	assert_int_equal(t.report.rank[TRAIN_SKIN], 4);
	assert_int_equal(t.report.rank_inputs[TRAIN_LEFT], 5);
	assert_int_equal(t.report.rank_inputs[TRAIN_SKIN], 12);
	NEAR(t.report.folding_px, 0, 1e-9);
	NEAR(t.report.curve[TRAIN_SKIN].linear[3], 0, 1e-6);
	assert_true(t.report.curve[TRAIN_SKIN].linear[2] > 0.01 && t.report.n_warnings == 0);
	for (int e = 0; e < 2; e++)
		for (int lid = 0; lid < 2; lid++) {
			NEAR(t.model.closed[5 * e + 3 + lid], t.clip->closed[5 * e + 3 + lid], 1e-9);
			NEAR(t.model.open[5 * e + 3 + lid], t.clip->open[5 * e + 3 + lid], 1e-9);
			for (int k = 0; k < 3; k++)  // blinks' flanks and wide moments stay in: Huber's weights leave that much of them
				NEAR(t.model.baseline[e][lid][k], t.clip->A[e][lid][k], k == 2 ? 0.02 : 0.002);
		}
	trained_free(&t);
}

/* No skin was followed: lids are learnt as exactly, kept in files and read back; no leverage is told of a skin. Also of a long clip. */
static void lids_alone(void **state)
{
	(void)state;
	for (int n = 900; n < 10000; n *= 10) {
		struct linear_clip_conf f = usual;
		struct skin_model read;
		struct err err = { 0 };
		double rms, h[3], g[SKIN_EYE_INPUTS + 2] = { 0 };
		f.n = n;
		f.n_vertices = 0;
		struct trained t = train(&f, &train_defaults);
		if (!t.ok)
			fail_msg("%s", t.err.msg);
		NEAR(held_out(&t, &rms), 0, 1e-6);
		assert_int_equal(t.model.n_skin_pc, 0);
		assert_int_equal(t.report.n_warnings, 0);
		assert_true(t.report.curve[TRAIN_LEFT].n > 0 && t.report.curve[TRAIN_SKIN].n == 0);
		for (int i = 0; i < f.n_au; i++)
			t.model.au_names[i] = mem_str(i ? "b" : "a");
		if (!skin_model_save(&t.model, scratch_path("."), 0, &err) || !skin_model_load(&read, scratch_path("."), &err))
			fail_msg("%s", err.msg);
		assert_memory_equal(read.L, t.model.L, (size_t)(read.n_lid_pc * (SKIN_EYE_INPUTS + 1)) * sizeof *read.L);
		skin_model_leverage(h, &read, g);
		assert_true(h[0] > 0 && h[1] > 0 && isnan(h[2]));
		skin_model_free(&read);
		trained_free(&t);
	}
}

/* All numbers stay what they are in other units, and whether rows are kept or squared. */
static void same_in_all_ways(void **state)
{
	(void)state;
	double rms;
	struct linear_clip_conf f = usual;
	f.n = 400;  // rows are kept
	struct trained t = train(&f, &train_defaults);
	assert_true(t.ok);
	NEAR(held_out(&t, &rms), 0, 1e-6);
	trained_free(&t);
	f = usual;
	f.repeated = true;
	t = train(&f, &train_defaults);
	assert_true(t.ok);
	NEAR(held_out(&t, &rms), 0, 1e-6);
	trained_free(&t);
	for (double scale = 1e-30; scale <= (SANITISED ? 1e-30 : 100); scale = scale < 1e-3 ? 1e-3 : scale * 1e5) {
		f = usual;
		f.scale = scale;
		t = train(&f, &train_defaults);
		assert_true(t.ok);
		NEAR(held_out(&t, &rms) / scale, 0, 1e-5);
		trained_free(&t);
	}
	f = usual;
	f.n_vertices = 700;  // more columns than frames
	f.n = 600;
	t = train(&f, &train_defaults);
	assert_true(t.ok);
	NEAR(held_out(&t, &rms), 0, 1e-6);
	trained_free(&t);
}

/* Noise, a tenth of the numbers missing, one frame in twenty lost altogether. */
static void robust(void **state)
{
	(void)state;
	double clean, gaps, lost;
	struct linear_clip_conf f = usual;
	f.n = 1200;
	f.noise = 0.3;
	struct trained t = train(&f, &train_defaults);
	held_out(&t, &clean);
	// Two thirds of the noise of one number: sigma * sqrt(regressors / frames) is 0.05, inputs beyond the clip cost the rest.
	NEAR(clean, 0, 0.2);
	trained_free(&t);
	f.missing = 0.1;
	t = train(&f, &train_defaults);
	held_out(&t, &gaps);
	NEAR(t.report.filled[TRAIN_SKIN], 0.1, 0.01);
	trained_free(&t);
	f.outliers = 0.05;
	t = train(&f, &train_defaults);
	held_out(&t, &lost);
	NEAR(t.report.outlying[TRAIN_SKIN], 0.05, 0.02);
	trained_free(&t);
	assert_true(gaps < 1.3 * clean + 0.01 && lost < 1.3 * clean + 0.01);
}

/* Standard errors: over clips that differ in noise alone, errors spread as the jackknife says. */
static void calibrated(void **state)
{
	(void)state;
	double z2 = 0, W[4 * 13];
	int n = 0;
	struct linear_clip_conf f = usual;
	f.n = 480;
	f.noise = 1;
	f.no_right = true;  // two eyes that move together leave a bias of the ridge, which no jackknife shows
	for (f.seed = 1; f.seed <= (SANITISED ? 1 : 3); f.seed++) {
		struct linear_clip_conf exact = f;
		exact.noise = 0;
		exact.n = 900;
		struct trained t = train(&f, &train_defaults), truth = train(&exact, &train_defaults);
		skin_model_fold(W, &t.model);
		for (int v = 0; v < 2 * f.n_vertices; v += 7)
			for (int k = 0; k < 13; k++) {
				// dU / dc of one coordinate, which does not depend on the choice of components
				double got = 0, want = 0, sigma2 = 0, W1[4 * 13];
				skin_model_fold(W1, &truth.model);
				for (int e = 0; e < 4; e++) {
					got += t.model.J[4 * v + e] * W[13 * e + k];
					want += truth.model.J[4 * v + e] * W1[13 * e + k];
					sigma2 += pow(t.model.J[4 * v + e] * t.model.W_sigma[13 * e + k], 2);
				}
				if (k < 2) {  // angles: apertures' controls depend on closed and open too
					z2 += (got - want) * (got - want) / sigma2;
					n++;
				}
			}
		trained_free(&t);
		trained_free(&truth);
	}
	print_message("error / standard error: %.2f rms\n", sqrt(z2 / n));
	assert_true(sqrt(z2 / n) > 0.4 && sqrt(z2 / n) < 2.5);  // W's alone: J's own error comes on top
}

static void half_a_face(void **state)
{
	(void)state;
	struct linear_clip_conf f = usual;
	double rms;
	f.no_right = true;
	struct trained t = train(&f, &train_defaults);
	assert_true(t.ok);
	assert_true(isnan(t.model.l0[t.model.n_lid - 1]) && !isnan(t.model.l0[0]) && isnan(t.model.low[6]));
	assert_int_equal(t.report.curve[TRAIN_RIGHT].n, 0);
	// What the right lids did to the skin is nobody's: the clip holds none of it.
	NEAR(held_out(&t, &rms), 0, 1e-6);
	trained_free(&t);
}

static void not_enough(void **state)
{
	(void)state;
	struct linear_clip_conf f = usual;
	f.n = 13;
	struct trained t = train(&f, &train_defaults);
	assert_false(t.ok);
	ERR_HAS(t.err, "13 frames, must be more than the 13 components");
	trained_free(&t);
	f = usual;
	f.no_blink = true;
	t = train(&f, &train_defaults);
	assert_true(t.ok && t.report.never_closed && t.report.n_warnings == 1);
	assert_non_null(strstr(t.report.warnings[0], "film a blink"));
	assert_true(t.model.closed[3] == 0);
	trained_free(&t);
	struct train_conf small = train_defaults;
	small.memory_mb = 16;
	f = usual;
	f.n_vertices = 3000;
	t = train(&f, &small);
	assert_false(t.ok);
	ERR_HAS(t.err, "train.memory_mb = 16");
	trained_free(&t);
}

static void never_shown(void **state)
{
	(void)state;
	struct linear_clip *c = linear_clip_new(&usual);
	struct train_clip clip = linear_clip_train(c);
	struct train_conf conf = train_defaults;
	struct skin_model model;
	struct train_report report;
	struct err err = { 0 };
	conf.brief = true;
	for (long i = 0; i < c->conf.n; i++)
		c->g[i * 12 + 11] = i % 3 ? 0 : NAN;
	assert_true(train_run(&model, &report, &clip, &conf, &err));
	assert_int_equal(report.n_warnings, 1);
	assert_non_null(strstr(report.warnings[0], "expression 2 of 2 is never shown"));
	skin_model_free(&model);
	train_report_free(&report);
	for (long i = 0; i < c->conf.n; i++)  // no gaze at all
		for (int k = 0; k < 10; k++)
			c->g[i * 12 + k] = NAN;
	assert_false(train_run(&model, &report, &clip, &conf, &err));
	ERR_HAS(err, "neither eye");
	skin_model_free(&model);
	train_report_free(&report);
	linear_clip_free(c);
}

/* A clip whose lids are lost in every blink: what they do then, and when eyes open wide, is not known and said to be, for the
 * frames concerned and no others. */
struct blinkless {
	struct linear_clip *clip;
	bool (*read)(void *ctx, long first, long n, double *lid, double *skin, double *seen, struct err *err);
};

static bool apart(const struct linear_clip *c, long frame)
{
	const double *g = c->g + frame * 12;
	double plane = c->A[0][0][0] * g[0] + c->A[0][0][1] * g[1] + c->A[0][0][2];
	return fabs((g[3] - c->closed[3]) / (c->open[3] - c->closed[3]) - plane) > 1e-9;
}

static bool read_blinkless(void *ctx, long first, long n, double *lid, double *skin, double *seen, struct err *err)
{
	struct blinkless *b = ctx;
	int n_lid = SKIN_LIDS * b->clip->conf.n_points * 2;
	if (!b->read(b->clip, first, n, lid, skin, seen, err))
		return false;
	for (long i = 0; i < n; i++)
		for (int k = 0; k < n_lid && apart(b->clip, first + i); k++)
			lid[i * n_lid + k] = NAN;
	return true;
}

static void outside(void **state)
{
	(void)state;
	struct linear_clip *c = linear_clip_new(&usual);
	struct train_clip clip = linear_clip_train(c);
	struct blinkless lost = { c, clip.read };
	struct train_conf conf = train_defaults;
	struct skin_model model;
	struct train_report report;
	struct err err = { 0 };
	long blinks = 0;
	conf.brief = true;
	clip.read = read_blinkless;
	clip.ctx = &lost;
	assert_true(train_run(&model, &report, &clip, &conf, &err));
	assert_int_equal(report.rank_inputs[TRAIN_LEFT], 3);
	for (long i = 0; i < c->conf.n; i++) {
		double h[TRAIN_PARTS];
		skin_model_leverage(h, &model, c->g + i * 12);
		assert_true((h[TRAIN_LEFT] > SKIN_REACH) == apart(c, i) && (h[TRAIN_SKIN] > SKIN_REACH) == apart(c, i));
		blinks += apart(c, i);
	}
	assert_true(blinks > 20 && blinks < 200);
	assert_int_equal(report.outside[TRAIN_LEFT], blinks);
	assert_int_equal(report.outside[TRAIN_RIGHT], blinks);
	assert_int_equal(report.outside[TRAIN_SKIN], 0);  // told of the lids already
	assert_int_equal(report.n_warnings, 2);
	assert_non_null(strstr(report.warnings[0], "the left eye's lids are lost"));
	skin_model_free(&model);
	train_report_free(&report);
	linear_clip_free(c);
}

static void threads(void **state)
{
	(void)state;
	struct linear_clip_conf f = usual;
	f.noise = 0.5;
	f.missing = 0.05;
	int all = omp_get_max_threads();
	omp_set_num_threads(1);
	struct trained a = train(&f, &train_defaults);
	omp_set_num_threads(3);
	struct trained b = train(&f, &train_defaults);
	omp_set_num_threads(all);
	assert_memory_equal(a.model.J, b.model.J, (size_t)(8 * f.n_vertices) * sizeof(double));
	assert_memory_equal(a.model.M, b.model.M, (size_t)(4 * (a.model.n_lid + 3)) * sizeof(double));
	assert_memory_equal(a.model.W_sigma, b.model.W_sigma, 4 * 13 * sizeof(double));
	trained_free(&a);
	trained_free(&b);
}

/* The bar: held-out error of the linear model at most 1.5 times that of the networks. */
static void rendered(void **state)
{
	(void)state;
	static const char *const clips[] = { "video/clip_a", "video/clip_b" };
	if (!bench_data("video"))
		skip();  // shared/data/video is not there
	const int first = SANITISED;  // the shorter one: the same code
	for (int i = first; i < 2; i++) {
		struct tracked tracked;
		struct skin_model model;
		struct train_report r;
		struct err err = { 0 };
		assert_true(tracked_load(&tracked, bench_data(clips[i]), 1, &err));
		struct train_clip clip = tracked_clip(&tracked);
		assert_true(train_run(&model, &r, &clip, &train_defaults, &err));
		int kept[TRAIN_PARTS] = { 12, 12, 3 };
		for (int p = 0; p < TRAIN_PARTS; p++)
			if (r.curve[p].n) {
				assert_true(r.curve[p].linear[kept[p]] <= 1.5 * r.curve[p].rbf[kept[p]]);
				assert_true(r.curve[p].linear[kept[p]] < (p == TRAIN_SKIN ? 0.4 : 0.25));
				assert_true(r.curve[p].pca[kept[p]] <= r.curve[p].linear[kept[p]]);
			}
		assert_true(r.curve[TRAIN_RIGHT].n == (i ? 0 : r.curve[TRAIN_LEFT].n));
		NEAR(r.folding_px, 0, 1e-6);
		skin_model_free(&model);
		train_report_free(&r);
		tracked_free(&tracked);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(known_maps), cmocka_unit_test(lids_alone), cmocka_unit_test(same_in_all_ways), cmocka_unit_test(robust),
		cmocka_unit_test(calibrated), cmocka_unit_test(half_a_face),      cmocka_unit_test(not_enough),
		cmocka_unit_test(never_shown), cmocka_unit_test(outside),         cmocka_unit_test(threads),
		cmocka_unit_test(rendered),
	};
	return cmocka_run_group_tests(tests, scratch_setup, scratch_teardown);
}
