/* Tilts near the front against drawn ones: directions of sight all as likely, their squares measured with noise. */
#include "limbus/rice.h"
#include "math/rng.h"
#include "tests/lib/unit.h"

static const double TURNED = 0.4;  // rad: the direction that is measured

/* Of drawn tilts whose noisy shape is about that vector: mean and deviation. along, across: sigmas; turn: of along, from the vector. */
static void drawn(double *mean, double *deviation, double theta, double along, double across, double turn, double prior)
{
	struct rng rng = { 7 };
	const double larger = fmax(along, across), most = theta * theta + 8 * larger, near = 0.25 * fmin(along, across);
	double sum = 0, one = 0, two = 0;
	for (int i = 0; i < 5000000; i++) {
		const double u = most * rng_uniform(&rng);  // a cap's area goes with the square of its radius
		const double way = 2 * M_PI * rng_uniform(&rng), n = along * rng_normal(&rng), o = across * rng_normal(&rng);
		const double x = u * cos(way) + n * cos(turn) - o * sin(turn) - theta * theta, y = u * sin(way) + n * sin(turn) + o * cos(turn);
		if (hypot(x, y) > near)
			continue;
		const double w = prior > 0 ? exp(-0.5 * u / (prior * prior)) : 1;
		sum += w;
		one += w * sqrt(u);
		two += w * u;
	}
	*mean = one / sum;
	*deviation = sqrt(two / sum - one / sum * one / sum);
}

static void covariance(double cov[2][2], double along, double across, double turn)
{
	const double c = cos(2 * TURNED + turn), s = sin(2 * TURNED + turn), p = along * along, q = across * across;
	cov[0][0] = p * c * c + q * s * s;
	cov[1][1] = p * s * s + q * c * c;
	cov[0][1] = cov[1][0] = (p - q) * c * s;
}

static void as_many_drawn_ones_say(void **state)
{
	(void)state;
	static const struct { double theta, along, across, turn, prior; } of[] = { { 0.1, 0.02, 0.02, 0, 0 }, { 0.1, 0.004, 0.004, 0, 0 }, { 0.3, 0.05, 0.05, 0, 0.2 },
		{ 0.1, 0.02, 0.008, 0, 0 }, { 0.15, 0.008, 0.02, 0, 0.5 }, { 0.15, 0.008, 0.02, 0.6, 0 }, { 0.05, 0.03, 0.01, 0, 0.5 } };
	for (int i = 0; i < 7; i++) {
		double mean, deviation, is_mean, is_deviation, cov[2][2];
		drawn(&is_mean, &is_deviation, of[i].theta, of[i].along, of[i].across, of[i].turn, of[i].prior);
		covariance(cov, of[i].along, of[i].across, of[i].turn);
		NEAR(rice_astray(is_mean, of[i].theta, TURNED, cov, of[i].prior), is_deviation, 0.03 * is_deviation);
		NEAR(rice_astray(0, of[i].theta, TURNED, cov, of[i].prior), hypot(is_mean, is_deviation), 0.02 * hypot(is_mean, is_deviation));
		if (of[i].along != of[i].across)
			continue;
		rice_tilt(&mean, &deviation, of[i].theta, of[i].along, of[i].prior);
		NEAR(mean, is_mean, 0.02 * is_mean);
		NEAR(deviation, is_deviation, 0.03 * is_deviation);
	}
}

/* The derivative of the root: 1 / (2 theta). */
static void what_is_sharp_stays(void **state)
{
	(void)state;
	double mean, deviation, cov[2][2];
	rice_tilt(&mean, &deviation, 0.3, 1e-4, 0.5);
	NEAR(mean, 0.3, 1e-5);
	NEAR(deviation, 1e-4 / 0.6, 1e-6);
	rice_tilt(&mean, &deviation, 0.3, 0, 0.5);
	NEAR(mean, 0.3, 0);
	NEAR(deviation, 0, 0);
	rice_tilt(&mean, &deviation, 0, 0.01, 0);
	assert_true(mean > 0 && mean < 0.2 && deviation > 0);
	covariance(cov, 1e-4, 1e-4, 0);
	NEAR(rice_astray(0.3, 0.3, TURNED, cov, 0.5), 1e-4 / 0.6, 1e-6);
	covariance(cov, 0, 0, 0);
	NEAR(rice_astray(0.28, 0.3, TURNED, cov, 0.5), 0.02, 1e-12);
	// noise across the vector turns it, and makes it no shorter
	covariance(cov, 0, 0.02, 0);
	NEAR(rice_astray(0.3, 0.3, TURNED, cov, 0), 0, 0.01);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(as_many_drawn_ones_say),
		cmocka_unit_test(what_is_sharp_stays),
	};
	return cmocka_run_group_tests(tests, 0, 0);
}
