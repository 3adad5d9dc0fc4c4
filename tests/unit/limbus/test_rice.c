/* Tilts near the front against drawn ones: directions of sight all as likely, their squares measured with noise. */
#include "limbus/rice.h"
#include "math/rng.h"
#include "tests/lib/unit.h"

/* Of drawn tilts whose noisy shape has about this length: mean and deviation. */
static void drawn(double *mean, double *deviation, double theta, double sigma, double prior)
{
	struct rng rng = { 7 };
	const double most = theta * theta + 8 * sigma, near = 0.05 * sigma;
	double sum = 0, one = 0, two = 0;
	for (int i = 0; i < 4000000; i++) {
		const double u = most * rng_uniform(&rng);  // a cap's area goes with the square of its radius
		const double seen = hypot(u + sigma * rng_normal(&rng), sigma * rng_normal(&rng));
		if (fabs(seen - theta * theta) > near)
			continue;
		const double w = prior > 0 ? exp(-0.5 * u / (prior * prior)) : 1;
		sum += w;
		one += w * sqrt(u);
		two += w * u;
	}
	*mean = one / sum;
	*deviation = sqrt(two / sum - one / sum * one / sum);
}

static void as_many_drawn_ones_say(void **state)
{
	(void)state;
	static const struct { double theta, sigma, prior; } of[] = { { 0.1, 0.02, 0 }, { 0.1, 0.004, 0 }, { 0.3, 0.05, 0 }, { 0.3, 0.05, 0.2 }, { 0.05, 0.03, 0.5 } };
	for (int i = 0; i < 5; i++) {
		double mean, deviation, is_mean, is_deviation;
		drawn(&is_mean, &is_deviation, of[i].theta, of[i].sigma, of[i].prior);
		rice_tilt(&mean, &deviation, of[i].theta, of[i].sigma, of[i].prior);
		NEAR(mean, is_mean, 0.02 * is_mean);
		NEAR(deviation, is_deviation, 0.03 * is_deviation);
	}
}

/* The derivative of the root: 1 / (2 theta). */
static void what_is_sharp_stays(void **state)
{
	(void)state;
	double mean, deviation;
	rice_tilt(&mean, &deviation, 0.3, 1e-4, 0.5);
	NEAR(mean, 0.3, 1e-5);
	NEAR(deviation, 1e-4 / 0.6, 1e-6);
	rice_tilt(&mean, &deviation, 0.3, 0, 0.5);
	NEAR(mean, 0.3, 0);
	NEAR(deviation, 0, 0);
	rice_tilt(&mean, &deviation, 0, 0.01, 0);
	assert_true(mean > 0 && mean < 0.2 && deviation > 0);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(as_many_drawn_ones_say),
		cmocka_unit_test(what_is_sharp_stays),
	};
	return cmocka_run_group_tests(tests, 0, 0);
}
