/* How many components train keeps: those that the clip's own equations have, and on a short noisy clip no more than help. */
#include "model/train/train.h"

#include "base/mem.h"
#include "math/rng.h"
#include "tests/lib/scenes/linear_clip.h"
#include "tests/lib/unit.h"

struct trained {
	struct skin_model model;
	struct train_report report;
	double rms;  // px, of skin predicted for inputs that the clip did not hold, against the truth
};

static double off_truth(const struct skin_model *m, const struct linear_clip *clip)
{
	int nu = 2 * m->n_vertices, n = 0;
	double *l = mem_new((size_t)m->n_lid, sizeof *l), *u = mem_new((size_t)nu, sizeof *u), *u1 = mem_new((size_t)nu, sizeof *u1);
	double g[SKIN_EYE_INPUTS + 2], sum = 0;
	struct rng rng = { 5 };
	for (int i = 0; i < 100; i++) {
		for (int k = 0; k < SKIN_EYE_INPUTS + 2; k++) {
			double x = rng_uniform(&rng);
			g[k] = k >= SKIN_EYE_INPUTS ? x : k % 5 == 2 ? 2 * x - 1 : k % 5 < 2 ? 40 * x - 20 : 10 + 25 * x;
			if (k >= 5 && k < 10)
				g[k] = g[k - 5] * (0.95 + 0.1 * x);
		}
		linear_clip_truth(l, u, clip, g);
		skin_model_lids(l, m, g);
		skin_model_skin(u1, 0, m, l, g + SKIN_EYE_INPUTS);
		for (int k = 0; k < nu; k++, n++)
			sum += (u[k] - u1[k]) * (u[k] - u1[k]);
	}
	free(l);
	free(u);
	free(u1);
	return sqrt(sum / n);
}

static struct trained train(long frames, double noise, uint64_t seed, bool choose)
{
	const struct linear_clip_conf f = { .n = frames, .n_points = 17, .n_vertices = 60, .n_au = 2, .fps = 60, .scale = 1, .noise = noise, .seed = seed };
	struct linear_clip *made = linear_clip_new(&f);
	struct train_clip clip = linear_clip_train(made);
	struct train_conf conf = train_defaults;
	struct trained t = { 0 };
	struct err err = { 0 };
	conf.brief = true;
	conf.choose = choose;
	assert_true(train_run(&t.model, &t.report, &clip, &conf, &err));
	t.rms = off_truth(&t.model, made);
	linear_clip_free(made);
	return t;
}

static void trained_free(struct trained *t)
{
	skin_model_free(&t->model);
	train_report_free(&t->report);
}

/* Lids of five inputs have five components, skin of rank four has four; nothing is lost of an exact clip. */
static void those_that_there_are(void **state)
{
	(void)state;
	struct trained t = train(900, 0, 1, true);
	print_message("exact: %d and %d components, %.2g px\n", t.model.n_lid_pc / 2, t.model.n_skin_pc, t.rms);
	assert_int_equal(t.model.n_lid_pc, 2 * 5);
	assert_int_equal(t.model.n_skin_pc, 4);
	assert_int_equal(t.report.curve[TRAIN_LEFT].kept, 5);
	assert_true(t.rms < 1e-6);
	trained_free(&t);
}

/* Five seconds with 2 px of noise: fewer than all, and nearer to the truth in the mean over clips. */
static void no_more_than_help(void **state)
{
	(void)state;
	enum { CLIPS = 6 };
	double few = 0, all = 0;
	for (uint64_t i = 0; i < CLIPS; i++) {
		struct trained a = train(300, 2, 10 + i, true), b = train(300, 2, 10 + i, false);
		print_message("noise: %d of %d components of the lids, %.3f px from the truth; all %.3f\n", a.model.n_lid_pc / 2, b.model.n_lid_pc / 2, a.rms, b.rms);
		assert_int_equal(b.model.n_lid_pc, 2 * 13);
		assert_true(a.model.n_lid_pc < b.model.n_lid_pc);
		few += a.rms / CLIPS;
		all += b.rms / CLIPS;
		trained_free(&a);
		trained_free(&b);
	}
	assert_true(few < all);
}

int main(void)
{
	const struct CMUnitTest tests[] = { cmocka_unit_test(those_that_there_are), cmocka_unit_test(no_more_than_help) };
	return cmocka_run_group_tests(tests, 0, 0);
}
