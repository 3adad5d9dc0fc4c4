/* What lids do with expressions: closed forms of what is added; training on frames that are known, with blinks in between. */
#include "model/express.h"

#include "base/file.h"
#include "base/mem.h"
#include "tests/lib/scenes/linear_clip.h"
#include "tests/lib/scratch.h"
#include "tests/lib/unit.h"

static const double px[EXPRESS_LIDS] = { 100, 20, 80, 40 };

static void added(void **state)
{
	(void)state;
	static const double by[2][EXPRESS_LIDS] = { { -0.02, -0.9, -0.1, -0.5 }, { 0.15, -0.1, 0.2, 0 } };
	double a[2] = { 0.8, 0.1 };
	express_eye(a, 0, 2, (double[]){ 0.5, 1 }, by, px, 1);
	NEAR(a[0], 0.8 - 0.01 + 0.15, 1e-15);
	NEAR(a[1], 0.1 - 0.45 - 0.1, 1e-15);  // below 0 where the other lid makes way: both together leave 94 - 9 = 83 px
	double right[2] = { 0.8, 0.1 };
	express_eye(right, 1, 2, (double[]){ 1, 0 }, by, px, 0.5);  // half shut: half of it
	NEAR(right[0], 0.75, 1e-15);
	NEAR(right[1], -0.15, 1e-15);
	double wide[2] = { 0.8, 0.1 };
	express_eye(wide, 1, 2, (double[]){ 1, NAN }, by, px, 1.3);  // wide: all of it, not more; not measured: none
	NEAR(wide[0], 0.7, 1e-15);
	double shut[2] = { 0 };
	express_eye(shut, 0, 2, (double[]){ 1, 1 }, by, px, 0);
	assert_true(shut[0] == 0 && shut[1] == 0);
}

/* No further than shut or wide open, both lids together; what is beyond already stays. */
static void limits(void **state)
{
	(void)state;
	static const double close[1][EXPRESS_LIDS] = { { -0.9, -2 } }, wide[1][EXPRESS_LIDS] = { { 0.9, 2 } };
	double a[2] = { 0.8, 0.1 }, b[2] = { 0.8, 0.1 }, c[2] = { 1.2, 0.3 };
	express_eye(a, 0, 1, (double[]){ 1 }, close, px, 1);
	NEAR(100 * a[0] + 20 * a[1], 0, 1e-12);
	NEAR((0.8 - a[0]) / (0.1 - a[1]), 0.45, 1e-12);  // in the same proportion
	express_eye(b, 0, 1, (double[]){ 1 }, wide, px, 1);
	NEAR(100 * b[0] + 20 * b[1], 120, 1e-12);
	express_eye(c, 0, 1, (double[]){ 1 }, wide, px, 1);
	assert_true(c[0] == 1.2 && c[1] == 0.3);
}

static const double truth[3][EXPRESS_LIDS] = { { -0.05, -0.4, -0.08, -0.3 }, { 0.2, 0.05, 0.25, 0 }, { 0 } };

/* 40 s of eyes that look about and blink; with two expressions lids go as told, in blinks in proportion; the second has who shows it blink twice a second; a third is never on. */
static struct linear_clip *expressive(void)
{
	struct linear_clip_conf f = { .n = 2400, .n_points = 8, .n_vertices = 0, .n_au = 3, .fps = 60, .scale = 1, .seed = 3 };
	struct linear_clip *c = linear_clip_new(&f);
	for (long i = 0; i < f.n; i++) {
		double *g = c->g + i * (SKIN_EYE_INPUTS + 3);
		g[SKIN_EYE_INPUTS + 2] *= 0.05;
		const double open = g[SKIN_EYE_INPUTS + 1] > 0.1 && fmod(c->time[i], 0.5) < 0.15 ? 0.05 : 1;
		for (int k = 0; k < EXPRESS_LIDS; k++) {
			const int at = k / 2 * 5 + 3 + k % 2;
			const double *a = c->A[k / 2][k % 2], usual = a[0] * g[k / 2 * 5] + a[1] * g[k / 2 * 5 + 1] + a[2];
			double more = 0;
			for (int e = 0; e < 3; e++)
				more += g[SKIN_EYE_INPUTS + e] * truth[e][k];
			g[at] = c->closed[at] + (g[at] - c->closed[at]) * (1 + more / usual) * open;
		}
	}
	return c;
}

/* What an expression does to a lid, px: open and closed are what the clip's own frames are at most and at least. */
static double in_px(const struct skin_model *m, double control, int k)
{
	double range[EXPRESS_LIDS];
	skin_model_range(range, m);
	return control * range[k];
}

static double true_px(const struct linear_clip *c, int e, int k)
{
	const int at = k / 2 * 5 + 3 + k % 2;
	return truth[e][k] * (c->open[at] - c->closed[at]);
}

/* Plain means over all frames in which an expression is on, blinks too: what must not be told. */
static double naive(const struct linear_clip *c, const struct skin_model *m, int e, int k)
{
	double xx = 0, xy = 0, control[SKIN_EYE_INPUTS + 3], usual[2];
	for (long i = 0; i < c->conf.n; i++) {
		const double *g = c->g + i * m->n_inputs, w = g[SKIN_EYE_INPUTS + e];
		skin_model_controls(control, m, g);
		skin_model_baseline(usual, m, k / 2, 1, g[k / 2 * 5], g[k / 2 * 5 + 1]);
		xx += w * w;
		xy += w * (control[k / 2 * 5 + 3 + k % 2] - usual[k % 2]);
	}
	return xy / xx;
}

/* skin_model_free, train_report_free. */
static void train(struct skin_model *m, struct train_report *report, struct linear_clip *c)
{
	struct train_clip clip = linear_clip_train(c);
	struct train_conf conf = train_defaults;
	struct err err = { 0 };
	conf.brief = true;
	if (!train_run(m, report, &clip, &conf, &err))
		fail_msg("%s", err.msg);
}

static void learnt(void **state)
{
	(void)state;
	struct linear_clip *c = expressive();
	struct skin_model m;
	struct train_report report;
	train(&m, &report, c);
	double off = 0;
	for (int k = 0; k < EXPRESS_LIDS; k++) {
		for (int e = 0; e < 2; e++) {
			NEAR(in_px(&m, m.expression[e][k], k), true_px(c, e, k), 0.2);  // of 83 px and 36: robust means leave some of blinks' flanks
			assert_true(m.expression_sigma[e][k] > 0 && in_px(&m, m.expression_sigma[e][k], k) < 0.2);
			off = fmax(off, fabs(in_px(&m, naive(c, &m, e, k), k) - true_px(c, e, k)));
		}
		assert_true(m.expression[2][k] == 0 && isnan(m.expression_sigma[2][k]));
	}
	assert_true(off > 4);
	skin_model_free(&m);
	train_report_free(&report);
	linear_clip_free(c);
}

/* Of an eye that was not followed nothing is told; the other one's is as ever. */
static void one_eye(void **state)
{
	(void)state;
	struct linear_clip *c = expressive();
	for (long i = 0; i < c->conf.n; i++)
		for (int k = 5; k < 10; k++)
			c->g[i * (SKIN_EYE_INPUTS + 3) + k] = NAN;
	c->conf.no_right = true;
	struct skin_model m;
	struct train_report report;
	train(&m, &report, c);
	NEAR(in_px(&m, m.expression[0][1], 1), true_px(c, 0, 1), 0.2);
	assert_true(m.expression[0][2] == 0 && m.expression[0][3] == 0 && isnan(m.expression_sigma[0][3]));
	skin_model_free(&m);
	train_report_free(&report);
	linear_clip_free(c);
}

/* Kept in model.json; a model of before, without it, tells nothing; nonsense is refused. */
static void kept(void **state)
{
	(void)state;
	struct skin_model m = { .n_au = 1, .n_points = 2, .n_vertices = 1, .n_lid_pc = 2, .n_skin_pc = 1 }, r;
	struct err err = { 0 };
	skin_model_alloc(&m);
	m.au_names[0] = mem_str("squint");
	memcpy(m.expression[0], truth[0], sizeof truth[0]);
	m.expression_sigma[0][1] = 0.01;
	m.expression_sigma[0][2] = NAN;
	if (!skin_model_save(&m, scratch_path("skin"), 0, &err) || !skin_model_load(&r, scratch_path("skin"), &err))
		fail_msg("%s", err.msg);
	NEAR(r.expression[0][1], truth[0][1], 1e-11);
	NEAR(r.expression_sigma[0][1], 0.01, 1e-11);
	assert_true(isnan(r.expression_sigma[0][2]));
	skin_model_free(&r);
	char *text, *at;
	size_t n;
	assert_true(file_read(&text, &n, scratch_path("skin/model.json"), 1 << 20, &err));
	char *was = mem_str(text);
	while ((at = strstr(text, "\"lids")))
		at[1] = 'L';
	assert_true(file_write(scratch_path("skin/model.json"), text, n, &err));
	if (!skin_model_load(&r, scratch_path("skin"), &err))
		fail_msg("%s", err.msg);
	assert_true(r.expression[0][1] == 0 && isnan(r.expression_sigma[0][1]));
	skin_model_free(&r);
	at = strstr(was, "-0.4");
	memcpy(at, "-4e9", 4);
	assert_true(file_write(scratch_path("skin/model.json"), was, n, &err));
	assert_false(skin_model_load(&r, scratch_path("skin"), &err));
	ERR_HAS(err, "lids: -4e+09: must be in [-100, 100]");
	free(text);
	free(was);
	skin_model_free(&m);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(added), cmocka_unit_test(limits), cmocka_unit_test(learnt), cmocka_unit_test(one_eye), cmocka_unit_test(kept),
	};
	return cmocka_run_group_tests(tests, scratch_setup, scratch_teardown);
}
