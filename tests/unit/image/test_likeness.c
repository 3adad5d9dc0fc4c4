/* tests/lib/score/likeness.h: pictures with noise of a known variance against what they are without any. */
#include "bridge/cv_blur.h"
#include "math/rng.h"
#include "tests/lib/score/likeness.h"
#include "tests/lib/unit.h"

enum { SIDE = 192 };

/* A matt ground with soft stripes, about as an eye's white and iris. */
static struct image ground(double contrast)
{
	struct image out = image_new(SIDE, SIDE, 4);
	for (int i = 0; i < SIDE * SIDE; i++) {
		const int x = i % SIDE, y = i / SIDE;
		const double stripes = y < SIDE / 2 ? 0 : contrast * sin(0.6 * x) * sin(0.2 * y);
		for (int c = 0; c < 3; c++)
			out.px[4 * i + c] = (float)(0.45 + 0.001 * x + stripes);
		out.px[4 * i + 3] = 1;
	}
	return out;
}

/* half, mean: out; the picture with independent noise, sigma in each half. */
static void with_noise(struct image half[2], struct image *mean, const struct image *m, double sigma)
{
	struct rng rng = { 11 };
	*mean = image_new(SIDE, SIDE, 4);
	for (int k = 0; k < 2; k++)
		half[k] = image_new(SIDE, SIDE, 4);
	for (long i = 0; i < 4L * SIDE * SIDE; i += 4)
		for (int k = 0; k < 2; k++) {
			const double n = sigma * rng_normal(&rng);
			for (int c = 0; c < 4; c++) {
				half[k].px[i + c] = m->px[i + c] + (c < 3 ? (float)n : 0);
				mean->px[i + c] += half[k].px[i + c] / 2;
			}
		}
}

/* likeness of `of` to `m` with noise: as it stands, and without. */
static void likenesses(double *with, double *without, const struct image *of, const struct image *m)
{
	struct image half[2], mean;
	with_noise(half, &mean, m, 0.015);
	*with = likeness_structure(of, &mean, 0, 1);
	*without = likeness_structure(of, &mean, (const struct image *const[2]){ &half[0], &half[1] }, 1);
	image_free(&mean);
	for (int k = 0; k < 2; k++)
		image_free(&half[k]);
}

/* The same picture: noise of 0.015 a half, as of 32 samples, costs a thirtieth of the likeness, and none of it once it is taken off, but for what the
 * spread of both variances in windows of some 28 pixels adds, (0.27 r)^2 twice, r = 0.08 the noise over what it is added to. */
static void noise_is_taken_off(void **state)
{
	(void)state;
	struct image m = ground(0.05);
	double with, without;
	NEAR(likeness_structure(&m, &m, 0, 1), 1, 1e-6);
	likenesses(&with, &without, &m, &m);
	assert_true(with < 0.97);
	NEAR(without, 1, 0.003);
	image_free(&m);
}

/* A picture that is another stays as unlike as it is without noise. */
static void differences_stay(void **state)
{
	(void)state;
	struct image m = ground(0.1), other = ground(0.02);
	const double is = likeness_structure(&m, &other, 0, 1);
	double with, without;
	likenesses(&with, &without, &m, &other);
	assert_true(is < 0.9);
	assert_true(with < is - 0.02);
	NEAR(without, is, 0.004);
	image_free(&m);
	image_free(&other);
}

int main(void)
{
	const struct CMUnitTest tests[] = { cmocka_unit_test(noise_is_taken_off), cmocka_unit_test(differences_stay) };
	return cmocka_run_group_tests(tests, 0, 0);
}
