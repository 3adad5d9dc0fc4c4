/* Relief: the filter against its own rendering, and against photons, which the model does not make. */
#include "tissue/relief/relief.h"
#include "tests/lib/scenes/irisphantom.h"
#include "tests/lib/unit.h"
#include "tests/peers/relief_render.h"

#define CHECK_NEAR(got, want, tolerance) assert_true(fabs((got) - (want)) <= (tolerance))

/* As in config/capture.conf. */
static const struct relief_conf conf = {
	.band = { 0.05, 0.12, 0.3 }, .relief_sigma = 0.2, .pitch = 0.04, .occlusion = 1, .reach = 0.08, .model_error = 0.3,
	.low = 0.1, .high = 1, .filter = true,
};
static const struct pigment_conf pigment = {
	.abl_thickness = 0.04, .cos_light = 0.84, .cos_view = 1, .bands = 3, .multiple = true
};
static const double white[3] = { 1, 1, 1 };
/* The whole patch lies between a pupil of no size and a root outside it. */
static const struct pupil point = { 0, 0, 0.001 };
static const double root = 6;

static const double blue[PIGMENT_N] = { -7, 0.7, -7, 0.7, -1.2, 0, 0, 0, 0 };
static const double green[PIGMENT_N] = { -3.5, 0.7, -5, 0.7, -1, 0, 0, 0, 0 };
static const double brown[PIGMENT_N] = { -1.6, 0.7, -3, 0.7, -0.5, 0, 0, 0, 0 };

static struct irisphantom phantom(const double x[PIGMENT_N], int n, long photons)
{
	struct tissue tissue = pigment_tissue(x, &pigment);
	return irisphantom_new(&tissue, n, 1, pigment.cos_light, 0.4, photons, 3);
}

/* rms of ln luminance between two pictures, smoothed a little: photons are noisy. */
static double difference(const struct image *a, const struct image *b)
{
	struct image la = image_new(a->width, a->height, 1), lb = image_new(a->width, a->height, 1);
	for (long i = 0; i < (long)a->width * a->height; i++) {
		const float *p = a->px + i * a->channels, *q = b->px + i * b->channels;
		la.px[i] = 0.2126f * p[0] + 0.7152f * p[1] + 0.0722f * p[2];
		lb.px[i] = 0.2126f * q[0] + 0.7152f * q[1] + 0.0722f * q[2];
	}
	double rms;
	irisphantom_correlation(&la, &lb, &rms);
	image_free(&la);
	image_free(&lb);
	return rms;
}

/* The rendering of the true relief against photons. Where scattering prevails nothing but noise (4 % a texel) and 3 % of
 * lateral light remain; where melanin does, hollows' darkening explains most of what there is. */
static void test_rendering(void **state)
{
	static const double *const eyes[] = { blue, green, brown };
	(void)state;
	for (int e = 0; e < 3; e++) {
		struct irisphantom p = phantom(eyes[e], 48, 300000);
		struct relief_conf without = conf;
		struct image with_it, without_it;
		struct err err = { 0 };
		without.occlusion = 0;
		assert_true(relief_render(&with_it, &p.truth, p.extent, white, eyes[e], &pigment, &conf, &err));
		assert_true(relief_render(&without_it, &p.truth, p.extent, white, eyes[e], &pigment, &without, &err));
		struct image flat = image_new(48, 48, 3);
		for (int i = 0; i < 3 * 48 * 48; i++)
			flat.px[i] = 1;
		double all = difference(&p.clean, &flat), plain = difference(&p.clean, &without_it), full = difference(&p.clean, &with_it);
		print_message("ln light of photons varies by %.3f; without hollows' darkening %.3f is left, with it %.3f\n", all, plain, full);
		assert_true(full < 0.08 && full < 0.75 * all);
		assert_true(e < 2 || full < 0.7 * plain);
		image_free(&with_it);
		image_free(&without_it);
		image_free(&flat);
		irisphantom_free(&p);
	}
}

/* Known gains come back when the photograph is the model's own and errors are said to be small; the relief they make better
 * than they themselves, because this smooth patch has little in the finest band. */
static void test_round_trip(void **state)
{
	struct irisphantom p = phantom(green, 96, 1000);  // its relief alone
	struct relief_conf sure = conf;
	struct relief_fit made = { .gain = { 1, 0.5, -0.3 } }, fit;
	struct image sharp, picture, again;
	struct err err = { 0 };
	(void)state;
	sure.model_error = 0.01;
	assert_true(relief_apply(&sharp, &p.truth, p.extent, &made, &sure, &err));
	assert_true(relief_render(&picture, &sharp, p.extent, white, green, &pigment, &sure, &err));
	for (int i = 0; i < 96 * 96; i++)
		memcpy(p.clean.px + 4 * i, picture.px + 3 * i, 3 * sizeof(float));
	assert_true(relief_solve(&fit, &p.clean, &p.truth, p.extent, &point, root, white, green, &pigment, &sure, &err));
	assert_true(relief_apply(&again, &p.truth, p.extent, &fit, &sure, &err));
	double rms;
	irisphantom_correlation(&sharp, &again, &rms);
	print_message("gains %.3f %.3f %.3f, ln thickness off by %.5f\n", fit.gain[0], fit.gain[1], fit.gain[2], rms);
	for (int b = 0; b < RELIEF_BANDS; b++)
		CHECK_NEAR(fit.gain[b], made.gain[b], 0.15);
	assert_true(rms < 0.005 && fit.after < 0.1 * fit.before);
	image_free(&again);
	image_free(&sharp);
	image_free(&picture);
	irisphantom_free(&p);
}

/* No filter: the coarse field itself. */
static void test_none(void **state)
{
	struct irisphantom p = phantom(green, 48, 1000);
	struct relief_fit none = { 0 };
	struct image out;
	struct err err = { 0 };
	(void)state;
	assert_true(relief_apply(&out, &p.truth, p.extent, &none, &conf, &err));
	for (int i = 0; i < 48 * 48; i++)
		CHECK_NEAR(out.px[i], p.truth.px[i], 1e-5);
	image_free(&out);
	irisphantom_free(&p);
}

/* Photons' picture in, relief out: nearer to the truth than the coarse field in blue, green and brown eyes. */
static void test_photons(void **state)
{
	static const double *const eyes[] = { blue, green, brown };
	static const char *const names[] = { "blue", "green", "brown" };
	(void)state;
	for (int e = 0; e < 3; e++) {
		struct irisphantom p = phantom(eyes[e], 48, 300000);
		struct relief_fit fit;
		struct image sharp;
		struct err err = { 0 };
		assert_true(relief_solve(&fit, &p.clean, &p.coarse, p.extent, &point, root, white, eyes[e], &pigment, &conf, &err));
		assert_true(relief_apply(&sharp, &p.coarse, p.extent, &fit, &conf, &err));
		double rms[2], r0 = irisphantom_correlation(&p.truth, &p.coarse, &rms[0]), r1 = irisphantom_correlation(&p.truth, &sharp, &rms[1]);
		print_message("%s: correlation %.3f -> %.3f, ln thickness off by %.3f -> %.3f (gains %.2f %.2f %.2f)\n", names[e], r0, r1, rms[0],
		              rms[1], fit.gain[0], fit.gain[1], fit.gain[2]);
		assert_true(rms[1] < rms[0]);
		assert_true(r1 > 0.6);
		assert_true(fit.after < fit.before);
		image_free(&sharp);
		irisphantom_free(&p);
	}
}

static void test_refusals(void **state)
{
	struct irisphantom p = phantom(green, 48, 10);
	struct relief_fit fit;
	struct err err = { 0 };
	(void)state;
	for (int i = 0; i < 48 * 48; i++)
		p.clean.px[4 * i + 3] = 0;
	assert_false(relief_solve(&fit, &p.clean, &p.coarse, p.extent, &point, root, white, green, &pigment, &conf, &err));
	assert_non_null(strstr(err.msg, "too few"));
	irisphantom_free(&p);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_rendering), cmocka_unit_test(test_round_trip), cmocka_unit_test(test_none),
		cmocka_unit_test(test_photons), cmocka_unit_test(test_refusals),
	};
	return cmocka_run_group_tests(tests, 0, 0);
}
