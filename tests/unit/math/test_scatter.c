/* Streaming means, scatter, components and regression against LAPACK's singular value decomposition of the whole. */
#include <cblas.h>
#include <float.h>
#include <lapacke.h>

#include "base/mem.h"
#include "math/linalg.h"
#include "math/rbf.h"
#include "math/regress.h"
#include "math/rng.h"
#include "math/scatter/scatter.h"
#include "tests/lib/unit.h"

/* n rows of p columns: k directions of falling strength, noise, a large mean. */
static double *low_rank(long n, int p, int k, double fall, double noise, double mean, uint64_t seed)
{
	struct rng rng = { seed };
	double *x = mem_new((size_t)n * (size_t)p, sizeof *x), *v = mem_new((size_t)(k * p), sizeof *v);
	for (int i = 0; i < k * p; i++)
		v[i] = rng_normal(&rng);
	for (long r = 0; r < n; r++) {
		for (int c = 0; c < p; c++)
			x[r * p + c] = mean * (1 + c % 7) + noise * rng_normal(&rng);
		double s = 1;
		for (int j = 0; j < k; j++, s *= fall) {
			double a = s * rng_normal(&rng);
			for (int c = 0; c < p; c++)
				x[r * p + c] += a * v[j * p + c];
		}
	}
	free(v);
	return x;
}

/* Direct: centred on the mean, dgesvd. values[min], vt[min][p]. */
static void direct(double *values, double *vt, long n, int p, const double *x, const double *w)
{
	int least = n < p ? (int)n : p;
	double *y = mem_new((size_t)n * (size_t)p, sizeof *y), *super = mem_new((size_t)least, sizeof *super);
	double *mean = mem_new((size_t)p, sizeof *mean), weight = 0;
	for (long r = 0; r < n; r++)
		weight += w ? w[r] : 1;
	for (long r = 0; r < n; r++)
		for (int c = 0; c < p; c++)
			mean[c] += (w ? w[r] : 1) / weight * x[r * p + c];
	for (long r = 0; r < n; r++)
		for (int c = 0; c < p; c++)
			y[r * p + c] = sqrt(w ? w[r] : 1) * (x[r * p + c] - mean[c]);
	double u;
	assert_int_equal(LAPACKE_dgesvd(LAPACK_ROW_MAJOR, 'N', 'S', (int)n, p, y, p, values, &u, least, vt, p, super), 0);
	free(y);
	free(mean);
	free(super);
}

/* 1 - |cos| between column k of V[p][K] and row k of vt. */
static double turned(int p, int K, int k, const double *V, const double *vt)
{
	double dot = 0;
	for (int i = 0; i < p; i++)
		dot += V[i * K + k] * vt[k * p + i];
	return 1 - fabs(dot);
}

static void compare(long n, int p, int keep, const double *x, const double *w, double tolerance, int k)
{
	struct scatter s;
	double *values = mem_new((size_t)p, sizeof *values), *vt = mem_new((size_t)p * (size_t)p, sizeof *vt);
	double *V = mem_new((size_t)(p * k), sizeof *V), *d = mem_new((size_t)k, sizeof *d);
	scatter_new(&s, p, keep);
	for (long at = 0, m; at < n; at += m) {
		m = n - at < 37 ? n - at : 37;
		if (w && at % 2) {  // into its own room, or copied there
			memcpy(scatter_rows(&s), x + at * p, (size_t)(m * p) * sizeof *x);
			scatter_take(&s, m, w + at);
		} else
			scatter_add(&s, m, x + at * p, w ? w + at : 0);
	}
	direct(values, vt, n, p, x, w);
	assert_int_equal(scatter_components(V, d, &s, 0, p, k), k);
	for (int i = 0; i < k; i++) {
		NEAR(d[i] / values[i], 1, tolerance);
		NEAR(turned(p, k, i, V, vt), 0, tolerance);
		for (int j = 0; j <= i; j++) {
			double dot = cblas_ddot(p, V + i, k, V + j, k);
			NEAR(dot, i == j, 1e-12);
		}
	}
	scatter_free(&s);
	free(values);
	free(vt);
	free(V);
	free(d);
}

/* The bar: equal to the direct decomposition to 1e-9 relative where that is well conditioned: singular values within
 * 1e3 of each other, each apart from the next by a quarter. */
static void equals_direct(void **state)
{
	(void)state;
	double *x = low_rank(600, 130, 20, 0.75, 1e-3, 300, 1), *w = mem_new(600, sizeof *w);
	for (int i = 0; i < 600; i++)
		w[i] = i % 5 ? 0.2 * (i % 7) + 0.1 : 1;
	compare(600, 130, 0, x, 0, 1e-9, 20);
	compare(600, 130, 0, x, w, 1e-9, 20);
	compare(600, 130, 1000, x, w, 1e-11, 20);
	compare(600, 130, 100, x, w, 1e-9, 20);  // rows first, then the matrix
	compare(90, 130, 90, x, w, 1e-11, 20);   // more columns than rows
	compare(90, 130, 0, x, 0, 1e-9, 20);
	free(x);
	free(w);
}

/* Known directions in double, the rest in single: what stands out of the rest keeps its digits. */
static void split(void **state)
{
	(void)state;
	enum { N = 3000, P = 150, K = 5, FROM = 20 };
	double *x = low_rank(N, P, K, 0.6, 0.05, 500, 8), *w = mem_new(N, sizeof *w);
	double values[P], *vt = mem_new(P * P, sizeof *vt), V[P * K], d[K], cross[FROM * P], direct_cross[FROM * P];
	double *u = mem_new(N * (P - FROM), sizeof *u), rough[(P - FROM) * K];
	struct scatter s, rows;
	for (int i = 0; i < N; i++) {
		w[i] = 0.5 + 0.5 * (i % 3);
		memcpy(u + i * (P - FROM), x + i * P + FROM, (P - FROM) * sizeof *u);
	}
	scatter_new(&rows, P, N);  // directions known from the first 200 rows
	scatter_add(&rows, 200, x, w);
	scatter_components(rough, d, &rows, FROM, P - FROM, K);
	scatter_free(&rows);
	scatter_new(&rows, P, N);
	scatter_add(&rows, N, x, w);
	scatter_cross(direct_cross, &rows, 0, FROM, 0, P);
	scatter_new(&s, P, 0);
	scatter_split(&s, FROM, K, rough);
	for (int at = 0; at < N; at += 750)
		scatter_add(&s, 750, x + at * P, w + at);
	scatter_join(&s);
	direct(values, vt, N, P - FROM, u, w);
	assert_int_equal(scatter_components(V, d, &s, FROM, P - FROM, K), K);
	for (int k = 0; k < K; k++) {
		NEAR(d[k] / values[k], 1, 1e-10);  // the rest is 0.05 of the least: 6e-8 * 0.05^2
		NEAR(turned(P - FROM, K, k, V, vt), 0, 1e-10);
	}
	scatter_cross(cross, &s, 0, FROM, 0, P);
	for (int i = 0; i < FROM * P; i++)
		NEAR(cross[i] / N, direct_cross[i] / N, 1e-9);
	scatter_free(&s);
	scatter_free(&rows);
	free(x);
	free(w);
	free(u);
	free(vt);
}

static void chan(void **state)
{
	(void)state;
	// A mean a million times the spread: squared sums would have lost every digit of the spread.
	double *x = low_rank(5000, 3, 3, 1, 0, 1e7, 2);
	struct scatter one, two;
	double a[9], b[9];
	scatter_new(&one, 3, 0);
	scatter_new(&two, 3, 5000);
	for (int at = 0; at < 5000; at += 100) {
		scatter_add(&one, 100, x + 3 * at, 0);
		scatter_add(&two, 100, x + 3 * at, 0);
	}
	scatter_cross(a, &one, 0, 3, 0, 3);
	scatter_cross(b, &two, 0, 3, 0, 3);
	for (int i = 0; i < 9; i++)
		NEAR(a[i] / b[i], 1, 1e-7);  // 1e7 * 2e-16 relative to a spread of 1, over 5000 rows
	NEAR(scatter_energy(&one, 1, 2) / (b[4] + b[8]), 1, 1e-7);
	scatter_free(&one);
	scatter_free(&two);
	free(x);
}

static int rank_of(long n, int p, const double *x, int keep, int k, double *d)
{
	struct scatter s;
	double *V = mem_new((size_t)(p * k), sizeof *V);
	scatter_new(&s, p, keep);
	scatter_add(&s, n, x, 0);
	int rank = scatter_components(V, d, &s, 0, p, k);
	for (int i = 0; i < p * k; i++)
		assert_true(isfinite(V[i]));
	for (int i = 0; i < k; i++)
		assert_true(isfinite(d[i]) && (i < rank) == (d[i] > 0));
	scatter_free(&s);
	free(V);
	return rank;
}

/* What a clip can be in its worst hour. */
static void stress(void **state)
{
	(void)state;
	double d[30];
	for (int keep = 0; keep <= 500; keep += 500) {
		double *x = low_rank(400, 30, 7, 0.5, 0, 100, 3);
		assert_int_equal(rank_of(400, 30, x, keep, 30, d), 7);
		assert_int_equal(rank_of(4, 30, x, keep, 30, d), 3);   // fewer rows than components
		assert_int_equal(rank_of(1, 30, x, keep, 30, d), 0);
		for (int i = 0; i < 400 * 30; i++)
			x[i] = 5;
		assert_int_equal(rank_of(400, 30, x, keep, 30, d), 0);  // nothing moves
		free(x);
		x = low_rank(400, 30, 7, 0.5, 0, 0, 3);
		for (int scale = -30; scale <= 30; scale += 60) {
			double *y = mem_new(400 * 30, sizeof *y);
			for (int i = 0; i < 400 * 30; i++)
				y[i] = x[i % (200 * 30)] * pow(10, scale);  // every frame twice, in other units
			assert_int_equal(rank_of(400, 30, y, keep, 30, d), 7);
			free(y);
		}
		free(x);
		// Singular values fall by 16 orders of magnitude: the large ones stay what they are.
		x = low_rank(400, 30, 17, 0.1, 0, 0, 4);
		double values[30], *vt = mem_new(30 * 30, sizeof *vt);
		direct(values, vt, 400, 30, x, 0);
		int rank = rank_of(400, 30, x, keep, 30, d);
		assert_true(rank >= (keep ? 14 : 7) && rank <= 17);
		for (int i = 0; i < rank && values[i] > 1e-5 * values[0]; i++)
			NEAR(d[i] / values[i], 1, 1e-3);  // the scatter matrix loses twice the digits: 1e-10 / (1e-5)^2 / 1e3
		free(vt);
		free(x);
	}
}

static void recovers_slopes(void **state)
{
	(void)state;
	struct rng rng = { 9 };
	enum { N = 300, Q = 5, R = 3 };
	static double x[N * Q], y[N * R], w[N];
	double b0[R][Q], b[R * Q], Gxx[Q * Q], Gxy[Q * R], mx[Q], my[R];
	for (int r = 0; r < R; r++)
		for (int q = 0; q < Q; q++)
			b0[r][q] = rng_normal(&rng);
	for (int i = 0; i < N; i++) {
		w[i] = rng_uniform(&rng);
		for (int q = 0; q < Q; q++)
			x[i * Q + q] = pow(10, 3 * q - 6) * (rng_normal(&rng) + 4);
		for (int r = 0; r < R; r++) {
			y[i * R + r] = 7;
			for (int q = 0; q < Q; q++)
				y[i * R + r] += b0[r][q] * x[i * Q + q];
		}
	}
	double weight = regress_moments(Gxx, Gxy, mx, my, N, Q, R, x, y, w);
	assert_int_equal(regress(b, Q, R, Gxx, Gxy, weight, mx, 0), Q);
	for (int r = 0; r < R; r++)
		for (int q = 0; q < Q; q++)
			NEAR(b[r * Q + q] / b0[r][q], 1, 1e-6 * pow(10, 12 - 3 * q) / 1e3);  // inputs span 12 orders of magnitude
	// A column twice, and a constant one: the shortest solution shares the slope, the constant gets nothing.
	for (int i = 0; i < N; i++) {
		x[i * Q + 1] = x[i * Q];
		x[i * Q + 2] = 1e6;
	}
	for (int i = 0; i < N; i++)
		y[i * R] = 2 * x[i * Q];
	weight = regress_moments(Gxx, Gxy, mx, my, N, Q, R, x, y, w);
	assert_int_equal(regress(b, Q, R, Gxx, Gxy, weight, mx, 0), 3);
	NEAR(b[0], 1, 1e-6);
	NEAR(b[1], 1, 1e-6);
	assert_true(b[2] == 0);
	// Closed form of one input: ridge shrinks the slope by 1 / (1 + ridge).
	weight = regress_moments(Gxx, Gxy, mx, my, N, 1, 1, (double[N]){ 1, 2, 3, -1 }, (double[N]){ 2, 4, 6, -2 }, w);
	regress(b, 1, 1, Gxx, Gxy, weight, mx, 0.25);
	NEAR(b[0], 2 / 1.25, 1e-12);
}

static void network(void **state)
{
	(void)state;
	// A sine over one period: 20 Gaussians follow it to a per cent, a line cannot; beyond the data it falls to a constant.
	enum { N = 400 };
	static double x[N], y[N], w[N], to[N];
	struct rng rng = { 11 };
	for (int i = 0; i < N; i++) {
		x[i] = rng_range(&rng, 0, 6.28);
		y[i] = sin(x[i]) + 3;
		w[i] = 1;
	}
	struct rbf rbf, again;
	rbf_centers(&rbf, 20, N, 1, x, w, 1);
	rbf_train(&rbf, 2, 1e-8, N, 1, x, y, w);
	rbf_predict(to, &rbf, N, x);
	for (int i = 0; i < N; i++)
		NEAR(to[i], y[i], 0.01);
	rbf_centers(&again, 20, N, 1, x, w, 1);
	assert_memory_equal(again.center, rbf.center, 20 * sizeof(double));
	rbf_free(&rbf);
	rbf_free(&again);
}

/* The leverage of rows is the diagonal of the hat matrix, by LAPACK's singular vectors: it sums to the rank. What no row varies
 * in is outside, however little; a constant input at its least difference. */
static void leverage(void **state)
{
	(void)state;
	enum { N = 30, Q = 5 };
	struct rng rng = { 3 };
	double x[N * Q], y[N] = { 0 }, w[N], Gxx[Q * Q], Gxy[Q], mx[Q], my[1], reach[Q * (Q + 1)], u[N * 3], s[3], vt[9], rest[3], sum = 0;
	double least[Q] = { INFINITY, INFINITY, INFINITY, INFINITY, 0.01 };
	for (int i = 0; i < N; i++) {
		w[i] = 1;
		for (int k = 0; k < 3; k++)
			x[i * Q + k] = 5 + pow(10, 3 * k) * rng_normal(&rng);
		x[i * Q + 3] = x[i * Q] - 2e-3 * x[i * Q + 1];
		x[i * Q + 4] = 7;
	}
	double weight = regress_moments(Gxx, Gxy, mx, my, N, Q, 1, x, y, w);
	regress_reach(reach, Q, Gxx, weight, mx, least);
	for (int i = 0; i < N; i++)
		for (int k = 0; k < 3; k++)
			u[i * 3 + k] = x[i * Q + k] - mx[k];
	assert_int_equal(LAPACKE_dgesvd(LAPACK_ROW_MAJOR, 'O', 'N', N, 3, u, 3, s, 0, 1, vt, 3, rest), 0);
	for (int i = 0; i < N; i++) {
		double h = regress_leverage(reach, Q, x + i * Q), want = 0;
		for (int k = 0; k < 3; k++)
			want += u[i * 3 + k] * u[i * 3 + k];
		NEAR(h, want, 1e-9);
		sum += h;
	}
	NEAR(sum, 3, 1e-9);
	double off[Q] = { x[0], x[1], x[2], x[3] + 0.01, 7 };
	assert_true(regress_leverage(reach, Q, off) > 1e3);
	double other[Q] = { mx[0], mx[1], mx[2], mx[3], 7.01 };
	NEAR(regress_leverage(reach, Q, other), 1, 1e-9);
	off[1] = NAN;
	assert_true(isnan(regress_leverage(reach, Q, off)));
	// In other units, the same.
	for (int i = 0; i < N * Q; i++)
		x[i] *= i % Q == 1 ? 1e-30 : 1;
	for (int i = 0; i < N; i++)
		x[i * Q + 3] = x[i * Q] - 2e27 * x[i * Q + 1];
	weight = regress_moments(Gxx, Gxy, mx, my, N, Q, 1, x, y, w);
	regress_reach(reach, Q, Gxx, weight, mx, least);
	for (int i = 0; i < N; i++)
		sum -= regress_leverage(reach, Q, x + i * Q);
	NEAR(sum, 0, 1e-9);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(equals_direct), cmocka_unit_test(split), cmocka_unit_test(chan), cmocka_unit_test(stress),
		cmocka_unit_test(recovers_slopes), cmocka_unit_test(network), cmocka_unit_test(leverage),
	};
	linalg_serial();
	return cmocka_run_group_tests(tests, 0, 0);
}
