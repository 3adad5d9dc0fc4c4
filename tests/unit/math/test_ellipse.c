/* Ellipses: closed forms, round trips, and the robust fit against the Cramér-Rao bound. */
#include "base/mem.h"
#include "math/ellipse_fit.h"
#include "math/rng.h"
#include "math/stats.h"
#include "tests/lib/unit.h"
#include "tests/peers/ellipse_bound.h"

static const struct ellipse E = { 321.25, -40.5, 100, 62, 0.7 };

static void assert_ellipse(const struct ellipse *got, const struct ellipse *want, double tol)
{
	assert_float_equal(got->cx, want->cx, tol);
	assert_float_equal(got->cy, want->cy, tol);
	assert_float_equal(got->a, want->a, tol);
	assert_float_equal(got->b, want->b, tol);
	assert_float_equal(remainder(got->angle - want->angle, M_PI), 0, tol);
}

static void test_forms(void **state)
{
	(void)state;
	double q[ELLIPSE_N], k[6];
	struct ellipse e;
	ellipse_to_q(q, &E);
	assert_true(ellipse_from_q(&e, q));
	assert_ellipse(&e, &E, 1e-12);
	ellipse_to_conic(k, &E);
	for (int i = 0; i < 6; i++)
		k[i] *= -3;  // a conic has no sign and no scale
	assert_true(ellipse_from_conic(&e, k));
	assert_ellipse(&e, &E, 1e-9);
	assert_false(ellipse_from_conic(&e, (double[6]){ 1, 0, -1, 0, 0, -1 }));
	assert_false(ellipse_from_conic(&e, (double[6]){ 1, 0, 1, 0, 0, 1 }));
	/* circle: 2 pi r; flat: 4 a within the formula's 0.04 % */
	assert_float_equal(ellipse_perimeter(&(struct ellipse){ 0, 0, 2, 2, 0 }), 4 * M_PI, 1e-12);
}

static void test_distance(void **state)
{
	(void)state;
	struct rng rng = { 1 };
	for (int i = 0; i < 1000; i++) {
		double t = rng_range(&rng, -M_PI, M_PI), p[2], n[2], got;
		ellipse_point(p, n, &E, t);
		/* inside, the normal is the shortest way up to the smallest radius of curvature b²/a = 38 */
		double d = rng_range(&rng, -30, 60);
		double far[2] = { p[0] + d * n[0], p[1] + d * n[1] };
		assert_float_equal(ellipse_distance(&got, &E, far), d, 1e-9);
		assert_float_equal(remainder(got - t, 2 * M_PI), 0, 1e-9);
	}
}

static void test_normal_shift(void **state)
{
	(void)state;
	/* moving q moves the distance of a fixed point by minus the shift: central differences */
	for (double t = 0.1; t < 6; t += 0.7) {
		double p[2], n[2], row[ELLIPSE_N], q[ELLIPSE_N], u;
		ellipse_point(p, n, &E, t);
		ellipse_normal_shift(row, &E, t);
		for (int i = 0; i < ELLIPSE_N; i++) {
			struct ellipse lo, hi;
			const double h = 1e-4;
			ellipse_to_q(q, &E);
			q[i] += h;
			ellipse_from_q(&hi, q);
			q[i] -= 2 * h;
			ellipse_from_q(&lo, q);
			double slope = (ellipse_distance(&u, &hi, p) - ellipse_distance(&u, &lo, p)) / (2 * h);
			assert_float_equal(slope, -row[i], 1e-6);
		}
	}
}

static int edge_points(struct rng *rng, int n, double (*p)[2], double *t, double sigma, double outliers)
{
	for (int i = 0; i < n; i++) {
		double normal[2];
		t[i] = 2 * M_PI * 0.7 * i / n;  // 30 % hidden
		ellipse_point(p[i], normal, &E, t[i]);
		double d = rng_uniform(rng) < outliers ? rng_range(rng, -30, 30) : sigma * rng_normal(rng);
		p[i][0] += d * normal[0];
		p[i][1] += d * normal[1];
	}
	return n;
}

static void test_exact(void **state)
{
	(void)state;
	struct rng rng = { 2 };
	double p[60][2], t[60];
	edge_points(&rng, 60, p, t, 0, 0);
	struct ellipse e;
	assert_true(ellipse_fit_direct(&e, 60, p, 0));
	assert_ellipse(&e, &E, 1e-8);
	struct ellipse_fit fit;
	assert_true(ellipse_fit_robust(&e, &fit, 60, p, 0, 0, 0.1, false));
	assert_ellipse(&e, &E, 1e-9);
	assert_false(ellipse_fit_direct(&e, 4, p, 0));
	double line[6][2] = { { 0, 0 }, { 1, 1 }, { 2, 2 }, { 3, 3 }, { 4, 4 }, { 5, 5 } };
	assert_false(ellipse_fit_direct(&e, 6, line, 0));
	assert_false(ellipse_fit_robust(&e, &fit, 6, line, 0, 0, 0, false));
}

/* Root mean square of the normalised errors (1 = the bound of the clean points alone), over 300 sets of 360 points. */
static double against_bound(double outliers)
{
	enum { CASES = 300, POINTS = 360 };
	struct rng rng = { 3 };
	double sum[ELLIPSE_N] = { 0 }, worst = 0, p[POINTS][2], t[POINTS], bound[ELLIPSE_N][ELLIPSE_N];
	for (int c = 0; c < CASES; c++) {
		edge_points(&rng, POINTS, p, t, 0.2, outliers);
		struct ellipse e;
		struct ellipse_fit fit;
		assert_true(ellipse_fit_robust(&e, &fit, POINTS, p, 0, 0, 0, false));
		double q[ELLIPSE_N], q0[ELLIPSE_N];
		ellipse_to_q(q, &e);
		ellipse_to_q(q0, &E);
		for (int i = 0; i < ELLIPSE_N; i++)
			sum[i] += (q[i] - q0[i]) * (q[i] - q0[i]);
	}
	assert_true(ellipse_bound(bound, &E, POINTS, t, 0.2));
	for (int i = 0; i < ELLIPSE_N; i++)
		worst = fmax(worst, sqrt(sum[i] / CASES / (bound[i][i] / (1 - outliers))));
	return worst;
}

static void test_bound(void **state)
{
	(void)state;
	/* Tukey's weights cost 2.5 % on clean data; the root mean square of 300 cases is good to 4 %. */
	assert_true(against_bound(0) < 1.1);
	assert_true(against_bound(0.3) < 1.15);
}

static void test_covariance(void **state)
{
	(void)state;
	enum { CASES = 500 };
	struct rng rng = { 4 };
	double p[200][2], t[200];
	int within = 0;
	for (int c = 0; c < CASES; c++) {
		edge_points(&rng, 200, p, t, 0.3, 0.1);
		struct ellipse e;
		struct ellipse_fit fit;
		assert_true(ellipse_fit_robust(&e, &fit, 200, p, 0, 0, 0, false));
		double s[ELLIPSE_N];
		ellipse_sigma(s, &e, fit.cov_q);
		within += fabs(e.cx - E.cx) < s[0];
		within += fabs(e.cy - E.cy) < s[1];
		within += fabs(e.a - E.a) < s[2];
		within += fabs(e.b - E.b) < s[3];
		within += fabs(remainder(e.angle - E.angle, M_PI)) < s[4];
	}
	/* 2500 correlated trials: 68.3 % plus or minus 1.5 % */
	assert_in_range(within, 2500 * 0.62, 2500 * 0.74);
}

/* Share of the parameters q within one of their sigmas where half of the ellipse is seen, TOGETHER neighbours share an error, and the prior is as
 * good as it says. */
static double within_known(double alike, double noise)
{
	enum { CASES = 400, POINTS = 200, TOGETHER = 4 };
	static const double sigma[ELLIPSE_N] = { 1.5, 1.5, 1, 0.6, 0.6 };
	struct rng rng = { 9 };
	double p[POINTS][2], normal[2], truth[ELLIPSE_N], q[ELLIPSE_N];
	int within = 0;
	ellipse_to_q(truth, &E);
	for (int c = 0; c < CASES; c++) {
		struct ellipse_prior known = { .alike = alike };
		struct ellipse e;
		struct ellipse_fit fit;
		double off = 0;
		for (int i = 0; i < ELLIPSE_N; i++) {
			known.sigma[i] = sigma[i];
			known.q[i] = truth[i] + sigma[i] * rng_normal(&rng);
		}
		for (int i = 0; i < POINTS; i++) {
			if (i % TOGETHER == 0)
				off = noise * rng_normal(&rng);
			ellipse_point(p[i], normal, &E, -0.6 + M_PI * i / POINTS);
			p[i][0] += off * normal[0];
			p[i][1] += off * normal[1];
		}
		assert_true(ellipse_from_q(&e, known.q) && ellipse_fit_near(&e, &fit, POINTS, p, 0, 0, 0.01, &known));
		ellipse_to_q(q, &e);
		for (int i = 0; i < ELLIPSE_N; i++)
			within += fabs(q[i] - truth[i]) < sqrt(TOGETHER * fit.cov_q[i][i] + fit.known_q[i][i]);
	}
	return (double)within / CASES / ELLIPSE_N;
}

static void test_known(void **state)
{
	(void)state;
	/* 68.3 %, of points that outweigh the prior and of points that it outweighs, whichever way they are weighed; the residuals of fifty groups are
	 * somewhat smaller than their errors */
	for (int i = 0; i < 4; i++)
		assert_in_range(1000 * within_known(i & 1 ? 4 : 100, i & 2 ? 0.2 : 3), 600, 740);
	/* no points: the prior alone */
	struct ellipse_prior known = { .sigma = { 2, 2, 2, 1, 1 }, .alike = 12 };
	struct ellipse e = E;
	struct ellipse_fit fit;
	double p[1][2];
	ellipse_to_q(known.q, &E);
	assert_true(ellipse_fit_near(&e, &fit, 0, p, 0, 0, 0.02, &known));
	for (int i = 0; i < ELLIPSE_N; i++)
		for (int j = 0; j < ELLIPSE_N; j++)
			assert_float_equal(fit.known_q[i][j], i == j ? known.sigma[i] * known.sigma[i] : 0, 1e-9);
	assert_ellipse(&e, &E, 1e-9);
}

static void test_stats(void **state)
{
	(void)state;
	double x[] = { 5, 1, 4, 2, 3, 9 };
	assert_float_equal(stats_median(6, x), 3.5, 0);
	assert_float_equal(stats_quantile(6, x, 0), 1, 0);
	assert_float_equal(stats_quantile(6, x, 1), 9, 0);
	assert_true(isnan(stats_median(0, x)));
	double y[] = { 1, 2, 3, 4, 100 };
	assert_float_equal(stats_mad(5, y, 3), 1.4826, 1e-12);
}

static int rising(const void *a, const void *b)
{
	double x = *(const double *)a, y = *(const double *)b;
	return (x > y) - (x < y);
}

/* Against sorting, with many equal values, on both sides of the number that is ranked without branches. */
static void test_median(void **state)
{
	(void)state;
	enum { MOST = 80 };
	unsigned seed = 1;
	for (int n = 1; n <= MOST; n++)
		for (int values = 2; values <= 1000; values *= 22) {
			double x[MOST], sorted[MOST];
			for (int i = 0; i < n; i++) {
				seed = seed * 1664525 + 1013904223;
				sorted[i] = x[i] = (double)(seed >> 8) / (1 << 24) < 0.1 ? -0.0 : (double)((seed >> 12) % (unsigned)values);
			}
			qsort(sorted, (size_t)n, sizeof *sorted, rising);
			assert_float_equal(stats_median(n, x), 0.5 * (sorted[(n - 1) / 2] + sorted[n / 2]), 0);
		}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_forms), cmocka_unit_test(test_distance), cmocka_unit_test(test_normal_shift),
		cmocka_unit_test(test_exact), cmocka_unit_test(test_bound), cmocka_unit_test(test_covariance), cmocka_unit_test(test_known),
		cmocka_unit_test(test_stats), cmocka_unit_test(test_median),
	};
	return cmocka_run_group_tests(tests, 0, 0);
}
