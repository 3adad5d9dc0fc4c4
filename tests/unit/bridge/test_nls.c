/* Least squares: against closed forms; covariance against (JᵀJ)⁻¹ by hand and against many noisy fits. */
#include "tests/lib/unit.h"

#include "bridge/nls.h"

/* y = x0 + x1 t at n places: both the solution and its covariance have closed forms. */
enum { N = 20 };
struct line {
	double y[N];
	int calls_with_jacobian;
};

static bool line_residuals(void *ctx, const double *x, double *r, double *J)
{
	struct line *l = ctx;
	for (int i = 0; i < N; i++) {
		r[i] = x[0] + x[1] * i - l->y[i];
		if (J) {
			J[2 * i] = 1;
			J[2 * i + 1] = i;
		}
	}
	l->calls_with_jacobian += J != 0;
	return true;
}

static double noise(unsigned *seed)
{
	// Sum of twelve uniforms: variance 1; its tails do not matter here.
	double sum = -6;
	for (int i = 0; i < 12; i++) {
		*seed = *seed * 1664525u + 1013904223u;
		sum += *seed / 4294967296.0;
	}
	return sum;
}

/* Normal equations of the straight line. */
static void line_by_hand(const struct line *l, double x[2], double cov[4])
{
	double s = N, st = 0, stt = 0, sy = 0, sty = 0;
	for (int i = 0; i < N; i++) {
		st += i;
		stt += i * i;
		sy += l->y[i];
		sty += i * l->y[i];
	}
	double det = s * stt - st * st;
	x[0] = (stt * sy - st * sty) / det;
	x[1] = (s * sty - st * sy) / det;
	cov[0] = stt / det;
	cov[1] = cov[2] = -st / det;
	cov[3] = s / det;
}

static void a_straight_line(void **state)
{
	(void)state;
	unsigned seed = 7;
	struct line l = { 0 };
	for (int i = 0; i < N; i++)
		l.y[i] = 3 - 0.5 * i + noise(&seed);
	for (int numeric = 0; numeric < 2; numeric++) {
		double x[2] = { 100, 100 }, want[2], cov[4], want_cov[4];
		struct nls_result result;
		struct nls_conf conf = { .numeric = numeric, .ftol = 1e-15 };
		struct err err = { 0 };
		line_by_hand(&l, want, want_cov);
		l.calls_with_jacobian = 0;
		if (!nls_solve(&result, 2, x, 0, 0, N, line_residuals, &l, &conf, cov, &err))
			fail_msg("%s", err.msg);
		assert_true(result.converged && result.rank == 2);
		assert_true(result.cost < result.cost0);
		assert_true(numeric || l.calls_with_jacobian > 0);
		for (int i = 0; i < 2; i++)  // the solver stops at steps of 1e-8 of x
			NEAR(x[i], want[i], 1e-6);
		for (int i = 0; i < 4; i++)
			NEAR(cov[i], want_cov[i], 1e-6 * fabs(want_cov[3]) + 1e-8);
	}
}

/* An exponential decay: the errors of many noisy fits have to be those the covariance foretells. */
enum { M = 40 };
struct decay {
	double y[M];
};

static bool decay_residuals(void *ctx, const double *x, double *r, double *J)
{
	struct decay *d = ctx;
	if (x[1] <= 0)
		return false;
	for (int i = 0; i < M; i++) {
		double t = 0.1 * i, e = exp(-t / x[1]);
		r[i] = (x[0] * e - d->y[i]) / 0.05;
		if (J) {
			J[2 * i] = e / 0.05;
			J[2 * i + 1] = x[0] * e * t / (x[1] * x[1]) / 0.05;
		}
	}
	return true;
}

static void covariance_foretells_errors(void **state)
{
	(void)state;
	enum { RUNS = 1000 };
	unsigned seed = 42;
	double z2[2] = { 0 };
	for (int run = 0; run < RUNS; run++) {
		struct decay d;
		for (int i = 0; i < M; i++)
			d.y[i] = 2 * exp(-0.1 * i / 1.5) + 0.05 * noise(&seed);
		double x[2] = { 1, 1 }, cov[4];
		struct nls_result result;
		struct err err = { 0 };
		assert_true(nls_solve(&result, 2, x, 0, 0, M, decay_residuals, &d, 0, cov, &err));
		z2[0] += (x[0] - 2) * (x[0] - 2) / cov[0];
		z2[1] += (x[1] - 1.5) * (x[1] - 1.5) / cov[3];
	}
	// Mean of RUNS squares of unit normals: 1 with s.d. sqrt(2 / RUNS) = 0.045; four of those, and the curvature
	// of the model adds a per cent.
	NEAR(z2[0] / RUNS, 1, 0.2);
	NEAR(z2[1] / RUNS, 1, 0.2);
}

/* x0 + x1 alone is measured: their difference is in the null space. x2 is measured by itself. */
static bool degenerate(void *ctx, const double *x, double *r, double *J)
{
	(void)ctx;
	for (int i = 0; i < 4; i++) {
		r[i] = i < 2 ? (i + 1) * (x[0] + x[1] - 3) : x[2] - 5;
		if (J) {
			J[3 * i] = J[3 * i + 1] = i < 2 ? i + 1 : 0;
			J[3 * i + 2] = i < 2 ? 0 : 1;
		}
	}
	return true;
}

static void what_is_not_measured_is_infinite(void **state)
{
	(void)state;
	double x[3] = { 0, 0, 0 }, cov[9];
	struct nls_result result;
	struct err err = { 0 };
	if (!nls_solve(&result, 3, x, 0, 0, 4, degenerate, 0, 0, cov, &err))
		fail_msg("%s", err.msg);
	assert_int_equal(result.rank, 2);
	NEAR(x[0] + x[1], 3, 1e-6);
	NEAR(x[2], 5, 1e-6);
	assert_true(isinf(cov[0]) && isinf(cov[4]));
	NEAR(cov[8], 0.5, 1e-9);  // two measurements of unit variance
	assert_true(cov[1] == 0 && cov[2] == 0 && cov[5] == 0);
}

/* Two correlated parameters, one pressed against its bound: the other still has to reach its own minimum. */
static void bounds_hold(void **state)
{
	(void)state;
	unsigned seed = 3;
	struct line l = { 0 };
	for (int i = 0; i < N; i++)
		l.y[i] = 3 - 0.5 * i + 0.1 * noise(&seed);
	struct nls_conf conf = { .ftol = 1e-15 };
	double x[2] = { 0, 0 }, lo[2] = { -10, -0.2 }, hi[2] = { 10, 0.2 };
	struct nls_result result;
	struct err err = { 0 };
	assert_true(nls_solve(&result, 2, x, lo, hi, N, line_residuals, &l, &conf, 0, &err));
	NEAR(x[1], -0.2, 1e-9);
	// With the slope held, the best offset is the mean of y + 0.2 t.
	double mean = 0;
	for (int i = 0; i < N; i++)
		mean += (l.y[i] + 0.2 * i) / N;
	NEAR(x[0], mean, 1e-6);
	// A bound that is passed on the way and let go again: the start is on the wrong side of everything.
	double y[2] = { 9, 0.2 }, high[2] = { 10, 0.2 }, low[2] = { -10, -2 }, want[2], cov[4];
	line_by_hand(&l, want, cov);
	assert_true(nls_solve(&result, 2, y, low, high, N, line_residuals, &l, &conf, 0, &err));
	NEAR(y[0], want[0], 1e-6);
	NEAR(y[1], want[1], 1e-6);
}

static void jacobians_are_checked(void **state)
{
	(void)state;
	struct decay d = { { 0 } };
	double x[2] = { 2, 1.5 };
	assert_true(nls_check_jacobian(2, x, M, decay_residuals, &d) < 1e-6);
	struct line l = { 0 };
	assert_true(nls_check_jacobian(2, x, N, line_residuals, &l) < 1e-6);
}

static bool never(void *ctx, const double *x, double *r, double *J)
{
	(void)ctx;
	(void)x;
	(void)r;
	(void)J;
	return false;
}

static bool not_a_number(void *ctx, const double *x, double *r, double *J)
{
	(void)ctx;
	r[0] = r[1] = x[0] * NAN;
	if (J)
		J[0] = J[1] = NAN;
	return true;
}

static void nonsense_is_an_error(void **state)
{
	(void)state;
	double x[1] = { 1 }, cov[1];
	struct nls_result result;
	struct err err = { 0 };
	assert_false(nls_solve(&result, 1, x, 0, 0, 2, never, 0, 0, cov, &err));
	assert_true(err_is(&err));
	err = (struct err){ 0 };
	assert_false(nls_solve(&result, 1, x, 0, 0, 2, not_a_number, 0, 0, cov, &err));
	assert_true(err_is(&err));
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_straight_line),
		cmocka_unit_test(covariance_foretells_errors),
		cmocka_unit_test(what_is_not_measured_is_infinite),
		cmocka_unit_test(bounds_hold),
		cmocka_unit_test(jacobians_are_checked),
		cmocka_unit_test(nonsense_is_an_error),
	};
	return cmocka_run_group_tests(tests, 0, 0);
}
