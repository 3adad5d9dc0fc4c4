/* Melanin: known parameters are recovered, standard deviations hold, colours by Monte Carlo (independent of the model). */
#include "base/file.h"
#include "base/mem.h"
#include "tissue/pigment/pigment.h"
#include "math/rng.h"
#include "tests/lib/scratch.h"
#include "tests/lib/truth/photon.h"
#include "tests/lib/unit.h"

#define CHECK_NEAR(got, want, tolerance) assert_true(fabs((got) - (want)) <= (tolerance))

/* The priors of config/pigment.conf. */
static struct pigment_conf plain(bool multiple)
{
	return (struct pigment_conf) {
		.prior = { { log(0.02), 1.5 }, { 0.7, 0.15 }, { log(0.01), 1.5 }, { 0.7, 0.15 }, { log(0.3), 0.7 },
		           { multiple ? 0 : log(2.2), multiple ? 0.25 : 0.5 }, { 0, 0.05 }, { 0, 0.05 }, { 0, 0.01 } },
		.abl_thickness = 0.04, .cos_light = 0.84, .cos_view = 1, .light_error = 0.25, .model_error = 0.1, .floor = 0.003,
		.bands = 4, .starts = 1, .multiple = multiple,
	};
}

/* A photograph of a tissue by the model itself, with the errors that conf says it has. */
static struct pigment_classes photograph(const double x[PIGMENT_N], const struct pigment_conf *conf, struct rng *rng)
{
	struct pigment_classes out = { .n = 16 };
	struct tissue tissue = pigment_tissue(x, conf);
	struct tissue_bands bands;
	struct tissue_optics optics;
	tissue_bands_make(&bands, conf->bands, conf->illuminant);
	tissue_optics_make(&optics, &tissue, &bands);
	for (int i = 0; i < out.n; i++) {
		struct pigment_class *c = &out.of[i];
		*c = (struct pigment_class) { .thickness = 0.2 + 0.5 * i / (out.n - 1), .share = 0.5, .texels = 1e6 };
		pigment_model(c->rgb, x, &optics, c->thickness, conf);
		double light = conf->light_error * rng_normal(rng);
		c->rgb[1] *= exp(light);
		c->rgb[0] *= exp(light + conf->model_error * rng_normal(rng));
		c->rgb[2] *= exp(light + conf->model_error * rng_normal(rng));
	}
	return out;
}

/* Truths drawn from the priors, photographs with the errors assumed: then the posterior's sigmas hold the truth in 68 %.
 * 60 eyes of six unknowns each, correlated: one sigma of the share is about 4 %. */
static void test_coverage(void **state)
{
	struct pigment_conf conf = plain(true);
	struct rng rng = { 7 };
	int inside = 0, n = 0;
	(void)state;
	conf.floor = 1e-5;
	for (int e = 0; e < (SANITISED ? 1 : 60); e++) {
		double truth[PIGMENT_N];
		for (int j = 0; j < PIGMENT_N; j++)
			truth[j] = conf.prior[j][0] + conf.prior[j][1] * rng_normal(&rng);
		truth[PIGMENT_VEIL] = fabs(truth[PIGMENT_VEIL]);
		truth[PIGMENT_ABL_MELANIN] = fmin(truth[PIGMENT_ABL_MELANIN], -0.6);
		truth[PIGMENT_STROMA_MELANIN] = fmin(truth[PIGMENT_STROMA_MELANIN], -0.6);
		struct pigment_classes classes = photograph(truth, &conf, &rng);
		struct pigment_fit fit;
		struct err err = { 0 };
		assert_true(pigment_solve(&fit, &classes, &conf, 0, &err));
		for (int j = 0; j <= PIGMENT_EXPOSURE; j++, n++)
			inside += fabs(fit.x[j] - truth[j]) < fit.sigma[j];
	}
	print_message("within one sigma: %.1f %%\n", 100.0 * inside / n);
	assert_true(SANITISED || (inside > 0.58 * n && inside < 0.80 * n));
}

/* With a card and known thickness, and little error, the pigment of the layer that light meets first comes back. */
static void test_recovery(void **state)
{
	struct pigment_conf conf = plain(true);
	struct rng rng = { 3 };
	const double truth[PIGMENT_N] = { log(0.08), 0.6, log(0.01), 0.7, log(0.4), 0, 0, 0, 0 };
	(void)state;
	conf.light_error = conf.model_error = 0.002;
	conf.floor = 1e-5;
	conf.prior[PIGMENT_EXPOSURE][1] = conf.prior[PIGMENT_RED][1] = conf.prior[PIGMENT_BLUE][1] = conf.prior[PIGMENT_VEIL][1] = 1e-3;
	struct pigment_classes classes = photograph(truth, &conf, &rng);
	struct pigment_fit fit;
	struct err err = { 0 };
	assert_true(pigment_solve(&fit, &classes, &conf, 0, &err));
	CHECK_NEAR(fit.x[PIGMENT_ABL_MELANIN], truth[PIGMENT_ABL_MELANIN], 0.1);
	CHECK_NEAR(fit.x[PIGMENT_SCALE], truth[PIGMENT_SCALE], 0.05);
	for (int j = 0; j < PIGMENT_N; j++)
		CHECK_NEAR(fit.x[j], truth[j], 4 * fit.sigma[j]);
}

/* From 12 places all over the priors: one minimum, or those that there are said. */
static void test_starts(void **state)
{
	struct pigment_conf conf = plain(true);
	struct rng rng = { 5 };
	const double truth[PIGMENT_N] = { log(0.03), 0.7, log(0.01), 0.7, log(0.3), 0, 0, 0, 0 };
	(void)state;
	struct pigment_classes classes = photograph(truth, &conf, &rng);
	struct pigment_fit one, many;
	struct err err = { 0 };
	assert_true(pigment_solve(&one, &classes, &conf, 0, &err));
	conf.starts = 12;
	assert_true(pigment_solve(&many, &classes, &conf, 0, &err));
	assert_true(many.cost <= one.cost + 1e-9);
	assert_true(many.minima == 1 || many.other[0][PIGMENT_N] < many.cost + 2);
	for (int j = 0; j < PIGMENT_N && many.minima == 1; j++)
		CHECK_NEAR(one.x[j], many.x[j], 0.1 * one.sigma[j]);
	// One photograph does not determine all nine: the directions that the priors determine are reported, as unit vectors.
	assert_true(many.directions >= 1 && many.directions < PIGMENT_N);
	double norm = 0;
	for (int j = 0; j < PIGMENT_N; j++)
		norm += many.direction[0][j] * many.direction[0][j];
	CHECK_NEAR(norm, 1, 1e-9);
	assert_true(many.information[0] < 1);
}

/* Photons through six irises, from blue to brown: the border layer's melanin rises sixfold at each step. */
enum { EYES = 5, DEPTHS = 5 };
static const double melanin[EYES] = { 0.001, 0.006, 0.03, 0.1, 0.3 };

static struct pigment_classes photons(double abl, const struct pigment_conf *conf)
{
	struct pigment_classes out = { .n = DEPTHS };
	struct tissue_bands bands;
	const double scale = 0.3, g = 0.8;  // not the anisotropy of the fit
	tissue_bands_make(&bands, 4, conf->illuminant);
	for (int i = 0; i < DEPTHS; i++) {
		struct pigment_class *c = &out.of[i];
		*c = (struct pigment_class) { .thickness = 0.25 + 0.1 * i, .share = 0.5, .texels = 1e4 };
		for (int k = 0; k < bands.n; k++) {
			float stroma = (float)c->thickness, r;
			double s = tissue_scattering(bands.nm[k]);
			struct photon_slab slab = { 1, 1, &stroma, 0.04, { s / (1 - g), scale * s / (1 - g) }, {
				tissue_absorption(&(struct tissue_layer) { abl, 0.7 }, bands.nm[k]),
				scale * tissue_absorption(&(struct tissue_layer) { abl / 4, 0.7 }, bands.nm[k]) }, g, false };
			photon_reflectance(&r, &slab, conf->cos_light, 40000, 0, (uint64_t)(k + 1));
			for (int j = 0; j < 3; j++)
				c->rgb[j] += bands.rgb[k][j] * r;
		}
	}
	return out;
}

/* All orders: melanin within a factor of 2 of the truth, in the right order, exposure and scale within 25 %. Single
 * scattering, the paper's: the order only; how far off it is stands in the benchmark. */
static void test_monte_carlo(void **state)
{
	double before[2] = { -100, -100 };
	(void)state;
	for (int e = 0; e < EYES; e += SANITISED ? 3 : 1) {
		struct pigment_conf all = plain(true), single = plain(false);
		struct pigment_classes classes = photons(melanin[e], &all);
		struct pigment_fit fit[2];
		struct err err = { 0 };
		all.light_error = single.light_error = 0.05;
		assert_true(pigment_solve(&fit[0], &classes, &all, 0, &err) && pigment_solve(&fit[1], &classes, &single, 0, &err));
		print_message("melanin %.3f: all orders %.4f (exposure %.2f, scale %.2f, residual %.1f %%), single %.4f (%.2f, %.2f, %.1f %%)\n",
		              melanin[e], exp(fit[0].x[0]), exp(fit[0].x[PIGMENT_EXPOSURE]), exp(fit[0].x[PIGMENT_SCALE]), 100 * fit[0].residual,
		              exp(fit[1].x[0]), exp(fit[1].x[PIGMENT_EXPOSURE]), exp(fit[1].x[PIGMENT_SCALE]), 100 * fit[1].residual);
		for (int m = 0; m < 2; m++) {
			assert_true(fit[m].x[PIGMENT_ABL_MELANIN] > before[m]);
			before[m] = fit[m].x[PIGMENT_ABL_MELANIN];
		}
		CHECK_NEAR(fit[0].x[PIGMENT_ABL_MELANIN], log(melanin[e]), fmax(log(2), 2.5 * fit[0].sigma[PIGMENT_ABL_MELANIN]));
		CHECK_NEAR(fit[0].x[PIGMENT_EXPOSURE], 0, log(1.25));
		CHECK_NEAR(fit[0].x[PIGMENT_SCALE], log(0.3), fmax(log(1.25), 1.5 * fit[0].sigma[PIGMENT_SCALE]));
	}
}

static void test_files(void **state)
{
	struct pigment_conf conf = plain(true), back = { 0 };
	struct rng rng = { 1 };
	const double truth[PIGMENT_N] = { log(0.03), 0.7, log(0.01), 0.6, log(0.3), 0.1, 0.02, -0.01, 0.004 };
	double x[PIGMENT_N], white[3];
	const char *path = scratch_path("pigment.json");
	struct err err = { 0 };
	struct pigment_fit fit;
	struct tissue tissue;
	(void)state;
	struct pigment_classes classes = photograph(truth, &conf, &rng);
	assert_true(pigment_solve(&fit, &classes, &conf, 0, &err));
	assert_true(pigment_save(&fit, &classes, &conf, path, 0, "{\"white\": {\"rgb\": [1, 0.9, 0.8]}}", &err));
	assert_true(pigment_load(x, white, &back, path, &err) && tissue_load(&tissue, path, &err));
	for (int j = 0; j < PIGMENT_N; j++)
		CHECK_NEAR(x[j], fit.x[j], 1e-9);
	CHECK_NEAR(white[2], 0.8, 0);
	assert_true(back.multiple && back.bands == 4 && tissue.multiple);
	CHECK_NEAR(tissue.thickness_scale, exp(fit.x[PIGMENT_SCALE]), 1e-9);
	assert_true(file_write(path, "{\"abl\": {\"melanin\": {\"value\": 7}}}", 34, &err));
	assert_false(tissue_load(&tissue, path, &err));
	assert_non_null(strstr(err.msg, "abl.melanin = 7"));
	err = (struct err) { 0 };
	assert_true(file_write(path, "{", 1, &err));
	assert_false(tissue_load(&tissue, path, &err));
}

/* The file of a grey photograph says why there are no pigments, and is none to read them from. */
static void test_none(void **state)
{
	(void)state;
	const char *path = scratch_path("pigment.json");
	char reason[256];
	struct tissue tissue;
	struct err err = { 0 };
	assert_true(pigment_save_none("the photographs are grey", path, "{}", "{\"white\": {\"level\": 0.5}}", &err));
	assert_true(tissue_without(reason, path));
	assert_string_equal(reason, "the photographs are grey");
	assert_false(tissue_load(&tissue, path, &err));
	scratch_text("pigment.json", "{}");
	assert_false(tissue_without(reason, path));
	assert_false(tissue_without(reason, scratch_path("none.json")));
}

/* Where melanin is told from above alone, what is reported is the mean of what it may be; the likeliest amount would be more. */
static void test_little(void **state)
{
	enum { EYES = SANITISED ? 1 : 24 };
	struct pigment_conf conf = plain(true);
	struct rng rng = { 17 };
	double sum = 0, square = 0;
	(void)state;
	conf.light_error = 0.06;
	conf.model_error = 0.04;
	for (int e = 0; e < EYES; e++) {
		double truth[PIGMENT_N] = { log(0.004), 0.7, log(0.003), 0.7, log(0.3) };
		for (int j = PIGMENT_EXPOSURE; j < PIGMENT_VEIL; j++)
			truth[j] = conf.prior[j][1] * rng_normal(&rng) / 2;
		struct pigment_classes classes = photograph(truth, &conf, &rng);
		struct pigment_fit fit;
		struct err err = { 0 };
		assert_true(pigment_solve(&fit, &classes, &conf, 0, &err));
		double off = fit.x[PIGMENT_ABL_MELANIN] - truth[PIGMENT_ABL_MELANIN];
		assert_true(fit.sigma[PIGMENT_ABL_MELANIN] > 0.6);
		sum += off;
		square += pow(off / fit.sigma[PIGMENT_ABL_MELANIN], 2);
	}
	print_message("melanin of 0.004: %.2f of that, off by %.2f sigma rms\n", exp(sum / EYES), sqrt(square / EYES));
	assert_true(SANITISED || (fabs(sum / EYES) < log(1.6) && square / EYES < 1));
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_coverage), cmocka_unit_test(test_recovery), cmocka_unit_test(test_starts), cmocka_unit_test(test_little),
		cmocka_unit_test(test_monte_carlo), SCRATCH_TEST(test_files), SCRATCH_TEST(test_none),
	};
	return cmocka_run_group_tests(tests, 0, 0);
}
