/* Coarse thickness: the profile at its knots, flat and tilted light, spots, hidden tissue, bad input. */
#include "base/file.h"
#include "iris/heightfield/heightfield.h"
#include "tests/lib/scratch.h"
#include "tests/lib/unit.h"

#define CHECK_NEAR(got, want, tolerance) assert_true(fabs((got) - (want)) <= (tolerance))

enum { SIZE = 512 };
static const double extent = 6.5, limbus = 5.85;
static const struct pupil middle = { 0, 0, 1.8 };
static const struct heightfield_conf conf = {
	.profile = { { 0.372, 0.457, 0.645 }, { 0.058, 0.080, 0.103 }, 0.5, 2, 0.6, 0.6, 0.8, 0.15 },
	.gain = 0.4, .fine = 0.02, .coarse = 0.6, .limit = 2, .reach = 0.15,
};

static void place(int i, int j, double *x, double *y)
{
	*x = (2 * (i + 0.5) / SIZE - 1) * extent;
	*y = (2 * (j + 0.5) / SIZE - 1) * extent;
}

typedef float light_fn(double x, double y);

static struct image paint(light_fn *light, light_fn *weight)
{
	struct image image = image_new(SIZE, SIZE, 4);
	for (int j = 0; j < SIZE; j++)
		for (int i = 0; i < SIZE; i++) {
			double x, y;
			place(i, j, &x, &y);
			float *p = image_at(&image, i, j);
			p[0] = p[1] = p[2] = light(x, y);
			p[3] = weight ? weight(x, y) : 1;
		}
	return image;
}

static struct heightfield_result run(light_fn *light, light_fn *weight)
{
	struct image clean = paint(light, weight);
	struct heightfield_result out;
	struct err err = { 0 };
	assert_true(heightfield_run(&out, &clean, extent, &middle, limbus, &conf, &err));
	image_free(&clean);
	return out;
}

static float even(double x, double y)
{
	(void)x, (void)y;
	return 0.2f;
}

static float tilted(double x, double y)  // twice as bright on one side as on the other
{
	return (float)(0.2 * exp2((x + 0.5 * y) / 12));
}

static float spotted(double x, double y)  // one bright, one dark spot, 0.1 mm wide, 4 mm right and left of the axis
{
	double a = exp(-(pow(x - 4, 2) + y * y) / 0.02), b = exp(-(pow(x + 4, 2) + y * y) / 0.02);
	return (float)(0.2 * exp(0.7 * a - 0.7 * b));
}

static float stripes(double x, double y)
{
	return (float)(0.2 * exp(0.4 * sin(24 * atan2(y, x))));
}

static float right_half(double x, double y)
{
	(void)y;
	return x > 0;
}

static double value(const struct heightfield_result *r, double x, double y, int channel)
{
	return image_sample(&r->map, (x / extent + 1) / 2 * SIZE, (y / extent + 1) / 2 * SIZE, channel);
}

static void test_share(void **state)
{
	const struct pupil off = { 0.3, -0.2, 1.5 };
	(void)state;
	for (int i = 0; i < 12; i++) {
		double c = cos(i * M_PI / 6), s = sin(i * M_PI / 6);
		CHECK_NEAR(iris_share(&off, 6, off.x + 1.5 * c, off.y + 1.5 * s), 0, 1e-12);
		CHECK_NEAR(iris_share(&off, 6, 6 * c, 6 * s), 1, 1e-12);
		CHECK_NEAR(iris_share(&off, 6, 0.15 + 3.75 * c, -0.1 + 3.75 * s), 0.5, 1e-12);
		assert_true(iris_share(&off, 6, off.x + 0.7 * c, off.y + 0.7 * s) < 0);
	}
}

/* ID1, ID2, ID3 at their places, monotone between. */
static void test_profile(void **state)
{
	struct profile p;
	double width = 6 - 1.8, sigma;
	(void)state;
	profile_make(&p, &conf.profile, width);
	CHECK_NEAR(profile_at(&p, 0.6 / width, &sigma), 0.645, 1e-12);
	CHECK_NEAR(sigma, 0.103, 1e-12);
	CHECK_NEAR(profile_at(&p, 1 - 2 / width, &sigma), 0.457, 1e-12);
	CHECK_NEAR(sigma, 0.080, 1e-12);
	CHECK_NEAR(profile_at(&p, 1 - 0.5 / width, &sigma), 0.372, 1e-12);
	CHECK_NEAR(profile_at(&p, -1, 0), 0.6 * 0.645, 1e-12);
	CHECK_NEAR(profile_at(&p, 2, 0), 0.8 * 0.372, 1e-12);
	for (double s = 0; s < 1; s += 0.001)
		assert_true((profile_at(&p, s + 0.001, 0) >= profile_at(&p, s, 0)) == (s + 0.0005 < 0.6 / width));
}

/* A pupil so wide that ID2's place lies at its margin: the two others remain, in order. */
static void test_wide_pupil(void **state)
{
	struct profile p;
	(void)state;
	profile_make(&p, &conf.profile, 2.1);
	assert_int_equal(p.n, 4);
	for (int i = 1; i < p.n; i++)
		assert_true(p.share[i] > p.share[i - 1]);
}

/* No detail: the profile itself, however the light falls. 1 % is 0.4 times a curvature of the light that a Gaussian of
 * 0.6 mm sees, and its one-sided means at the pupil and the limbus. */
static void test_light(void **state)
{
	(void)state;
	for (int t = 0; t < 2; t++) {
		struct heightfield_result r = run(t ? tilted : even, 0);
		struct profile p;
		profile_make(&p, &conf.profile, r.root - middle.r);
		for (double radius = 2; radius < 5.7; radius += 0.1)
			for (int i = 0; i < 24; i++) {
				double x = radius * cos(i * M_PI / 12), y = radius * sin(i * M_PI / 12);
				double want = profile_at(&p, iris_share(&middle, r.root, x, y), 0);
				CHECK_NEAR(value(&r, x, y, 0), want, (t ? 0.015 : 0.002) * want);
			}
		assert_true(r.seen > 0.99);
		image_free(&r.map);
	}
}

/* exp(0.4 * 0.7) thicker and thinner; the coarse mean takes a little of it, the limit a little more. */
static void test_lighter_is_thicker(void **state)
{
	(void)state;
	struct heightfield_result r = run(spotted, 0), flat = run(even, 0);
	double thick = value(&r, 4, 0, 0) / value(&flat, 4, 0, 0), thin = value(&r, -4, 0, 0) / value(&flat, -4, 0, 0);
	CHECK_NEAR(log(thick), 0.28, 0.04);
	CHECK_NEAR(log(thin), -0.28, 0.04);
	image_free(&r.map);
	image_free(&flat.map);
}

/* Where nothing was seen the profile stands, with more doubt; where something was, what is seen does not change. */
static void test_hidden(void **state)
{
	(void)state;
	struct heightfield_result all = run(stripes, 0), half = run(stripes, right_half), flat = run(even, 0);
	CHECK_NEAR(half.seen, 0.5, 0.01);
	for (int i = 0; i < 24; i++) {
		double a = (i - 11.5) / 24 * M_PI * 0.7, x = 3.8 * cos(a), y = 3.8 * sin(a);
		CHECK_NEAR(value(&half, x, y, 0), value(&all, x, y, 0), 0.01);
		CHECK_NEAR(value(&half, -x, y, 0), value(&flat, -x, y, 0), 0.01);
		assert_true(value(&half, -x, y, 1) > value(&flat, -x, y, 1));
	}
	image_free(&all.map);
	image_free(&half.map);
	image_free(&flat.map);
}

static void test_refusals(void **state)
{
	struct image clean = paint(even, 0);
	struct heightfield_result out;
	struct err err = { 0 };
	struct pupil pupil;
	const char *path = scratch_path("pupil.json");
	(void)state;
	assert_false(heightfield_run(&out, &clean, extent, &(struct pupil) { 0, 0, 5.8 }, limbus, &conf, &err));
	assert_non_null(strstr(err.msg, "brighter light"));
	image_free(&clean);
	err = (struct err) { 0 };
	assert_true(file_write(path, "{\"pupil\": {\"cx\": 0, \"cy\": 9, \"r\": 2}}", 36, &err));
	assert_false(pupil_load(&pupil, path, 1.8, &err));
	err = (struct err) { 0 };
	assert_true(file_write(path, "{\"pupil\": null}", 15, &err));
	assert_true(pupil_load(&pupil, path, 1.7, &err));
	CHECK_NEAR(pupil.r, 1.7, 0);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_share), cmocka_unit_test(test_profile), cmocka_unit_test(test_wide_pupil),
		cmocka_unit_test(test_light), cmocka_unit_test(test_lighter_is_thicker), cmocka_unit_test(test_hidden),
		SCRATCH_TEST(test_refusals),
	};
	return cmocka_run_group_tests(tests, 0, 0);
}
