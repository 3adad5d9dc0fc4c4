/* The light path: closed forms, round trips with the ray of sight, a bracketed solve in long double, the batches against the
 * solver, several paths, input that is none. */
#include "base/mem.h"
#include "math/vec.h"
#include "optics/lightpath/lightpath.h"
#include "tests/lib/truth/light_case.h"
#include "tests/lib/unit.h"

static const struct cornea generic = { .R = 7.8, .p = 0.75, .n = 1.336, .rim = 5.85 };

static double gap(const double a[3], const double b[3])
{
	return hypot(hypot(a[0] - b[0], a[1] - b[1]), a[2] - b[2]);
}

static void check(bool ok, const char *what, double got)
{
	if (!ok)
		fail_msg("%s: %.17g", what, got);
}

static void on_the_axis(void **state)
{
	(void)state;
	double K[3];
	for (double away = 1; away < 1e8; away *= 10) {
		assert_int_equal(lightpath_solve(K, &generic, (double[]){ 0, 0, 3.3 }, (double[]){ 0, 0, -away }), LIGHTPATH_OK);
		check(vec_norm(K) < 1e-15, "K off the axis", vec_norm(K));
	}
}

static void a_straight_line_without_a_step_of_index(void **state)
{
	(void)state;
	struct rng rng = { 11 };
	struct cornea c = generic;
	c.n = 1;
	int n = 0;
	for (int i = 0; i < 3000; i++) {
		double P[3] = { rng_range(&rng, -4, 4), rng_range(&rng, -4, 4), 3.3 }, C[3], K[3], hit[3], dir[3];
		for (int k = 0; k < 3; k++)
			C[k] = rng_range(&rng, -60, k == 2 ? -1 : 60);
		vec_add(dir, P, -1, C);
		if (!cornea_hit(hit, &c, C, dir))
			continue;
		n++;
		assert_int_equal(lightpath_solve(K, &c, P, C), LIGHTPATH_OK);
		// A line that grazes at angle a is cut to the rounding of its ends, 1e-15, over sin a: at 1 degree 1e-13.
		check(gap(K, hit) < 1e-12, "K against the straight line", gap(K, hit));
	}
	assert_true(n > 1000);
}

static void a_sphere_keeps_radii(void **state)
{
	(void)state;
	// p = 1: P and C on one line through the centre; K on it too.
	struct cornea c = { .R = 7.8, .p = 1, .n = 1.5, .rim = 7 };
	struct rng rng = { 5 };
	for (int i = 0; i < 1000; i++) {
		double a = rng_range(&rng, 0, 1), b = rng_range(&rng, 0, 2 * M_PI), r = rng_range(&rng, 3, 7), K[3];
		double e[3] = { sin(a) * cos(b), sin(a) * sin(b), -cos(a) }, P[3], C[3], want[3];
		for (int k = 0; k < 3; k++) {
			double center = k == 2 ? 7.8 : 0;
			P[k] = center + r * e[k];
			C[k] = center + 90 * e[k];
			want[k] = center + 7.8 * e[k];
		}
		enum lightpath_status status = lightpath_solve(K, &c, P, C);
		assert_int_equal(status, hypot(want[0], want[1]) > 7 ? LIGHTPATH_BEYOND_RIM : LIGHTPATH_OK);
		check(gap(K, want) < 1e-13, "K off the radius", gap(K, want));
	}
}

static void an_aplanatic_sphere(void **state)
{
	(void)state;
	// All light that aims at the point R n behind the centre meets at R / n behind it: from there every direction
	// leads to the K on its own line. R/n behind the centre lies past the equator: P 12 mm deep.
	struct cornea c = { .R = 7.8, .p = 1, .n = 1.336, .rim = 7 };
	double P[3] = { 0, 0, 7.8 + 7.8 / 1.336 }, far = 7.8 + 7.8 * 1.336;
	for (int i = 1; i < 30; i++) {
		double C[3] = { i, 0.3 * i, -60 }, dir[3] = { -C[0], -C[1], far - C[2] }, want[3], K[3];
		assert_true(cornea_hit(want, &c, C, dir));
		assert_int_equal(lightpath_solve(K, &c, P, C), LIGHTPATH_OK);
		check(gap(K, want) < 1e-12, "K on the aplanatic sphere", gap(K, want));
	}
}

/* Coplanar cases to 89.9 degrees, every index towards 1, every shape, camera 1 mm to 10 km: against bisection. */
static void against_a_bracketed_solve(void **state)
{
	(void)state;
	const double ns[] = { 1, 1 + 1e-9, 1 + 1e-6, 1.001, 1.336, 1.376, 2 }, ps[] = { 0, 1e-9, 0.5, 0.75, 1, 1.6 };
	int n = 0;
	for (int i = 0; i < COUNT(ns); i++) {
		for (int j = 0; j < COUNT(ps); j++) {
			struct cornea c = { .R = 7.8, .p = ps[j], .n = ns[i], .rim = 5.5 };
			for (int k = 0; k < 12; k++) {
				// Incidence towards 89.9 degrees at K; C away from it; P along the refracted ray.
				double x = -5 + 0.8 * k, a = (k % 4 == 3 ? 89.9 : 30.0 * (k % 4)) * M_PI / 180, N[3], in[3];
				double K[3] = { x, 0, cornea_depth(&c, x) }, away = pow(10, k % 8), C[3], P[3], found[8][3], got[3];
				cornea_normal(N, &c, K);
				double side[3] = { -N[2], 0, N[0] }, w[3], to[3];
				for (int q = 0; q < 3; q++) {
					w[q] = cos(a) * N[q] + (x > 0 ? -sin(a) : sin(a)) * side[q];
					C[q] = K[q] + away * w[q];
					to[q] = -w[q];
				}
				refract(in, to, N, 1, c.n);
				// Not further than the ray stays inside: it leaves again after 2 R cos t.
				vec_add(P, K, fmin(1.5, -vec_dot(in, N) * 7), in);
				C[1] = P[1] = 0;
				int m = light_case_bracketed(found, 8, &c, P, C, 0);
				if (m != 1)
					continue;
				assert_int_equal(lightpath_solve(got, &c, P, C), LIGHTPATH_OK);
				check(gap(got, found[0]) <= 1e-12, "K against bisection", gap(got, found[0]));
				check(light_case_snell(&c, P, C, 0, got) <= 1e-12, "Snell", light_case_snell(&c, P, C, 0, got));
				n++;
			}
		}
	}
	assert_true(n > 250);
}

static void random_cases(void **state)
{
	(void)state;
	const struct light_range ranges[] = {
		{ false, { 3.3, 3.3 }, 5.85, 90, { 0, 89.9 } },
		{ false, { 2.5, 5 }, 5.85, 130, { 0, 89.9 } },
		{ true, { 2.5, 5 }, 6, 90, { 0, 89.9 } },
	};
	for (int r = 0; r < COUNT(ranges); r++) {
		struct rng rng = { 100 + r };
		for (int i = 0; i < 60000; i++) {
			struct light_case c;
			double K[3];
			light_case_draw(&c, &rng, &ranges[r]);
			int point = i & 1;
			enum lightpath_status status = point ? lightpath_solve(K, &c.cornea, c.P, c.C)
			                                     : lightpath_solve_directional(K, &c.cornea, c.P, c.w);
			assert_int_equal(status, LIGHTPATH_OK);
			// The inputs' own rounding, times what the path makes of it.
			double tolerance = fmax(1e-12, 4e-15 * c.spread[point] * (1 + 1e-6 * c.spread[point]));
			enum light_verdict verdict = light_case_judge(&c, point, K, tolerance);
			assert_true(verdict == LIGHT_RIGHT || (verdict == LIGHT_OTHER_PATH && r > 0));
		}
	}
}

static void there_and_back(void **state)
{
	(void)state;
	// The ray of sight towards K, refracted, meets P.
	struct rng rng = { 8 };
	for (int i = 0; i < 2000; i++) {
		double a = rng_range(&rng, 0, 2 * M_PI), r = rng_range(&rng, 0, 4.5), P[3] = { r * cos(a), r * sin(a), 3.3 };
		double C[3] = { rng_range(&rng, -60, 60), rng_range(&rng, -60, 60), -80 }, K[3], hit[3], from[3], in[3], dir[3];
		if (lightpath_solve(K, &generic, P, C) != LIGHTPATH_OK)
			continue;
		vec_add(dir, K, -1, C);
		assert_true(cornea_sight(hit, from, in, &generic, C, dir));
		double t = (P[2] - from[2]) / in[2];
		vec_add(hit, from, t, in);
		check(gap(hit, P) < 1e-12, "round trip", gap(hit, P));
	}
}

static void no_number_comes_of_no_problem(void **state)
{
	(void)state;
	double K[3], in[3] = { 1, 0, 3.3 }, out[3] = { 0, 0, -80 }, bad[][3] = {
		{ NAN, 0, 3.3 }, { INFINITY, 0, 3.3 }, { 0, 0, -1 }, { 20, 0, 3 }, { 0, 0, 0 }, { 5.85, 0, 2.49 },
	};
	for (int i = 0; i < COUNT(bad); i++) {
		assert_int_equal(lightpath_solve(K, &generic, bad[i], out), LIGHTPATH_NONE);
		assert_true(K[0] == 0 && K[1] == 0 && K[2] == 0);
	}
	assert_int_equal(lightpath_solve(K, &generic, in, in), LIGHTPATH_NONE);
	assert_int_equal(lightpath_solve(K, &generic, in, (double[]){ NAN, 0, -80 }), LIGHTPATH_NONE);
	assert_int_equal(lightpath_solve_directional(K, &generic, in, (double[]){ 0, NAN, -1 }), LIGHTPATH_NONE);
	// Behind the iris, at the rim, beyond it.
	assert_int_equal(lightpath_solve(K, &generic, (double[]){ 2, 0, 7 }, out), LIGHTPATH_OK);
	assert_int_equal(lightpath_solve_directional(K, &generic, (double[]){ 5.8, 0, 3.3 }, (double[]){ 0.9, 0, -0.435 }),
	                 LIGHTPATH_BEYOND_RIM);
	assert_true(isfinite(K[0] + K[1] + K[2]));
	// Light from behind the head: nothing is lit.
	assert_int_equal(lightpath_solve_directional(K, &generic, in, (double[]){ 0, 0, 1 }), LIGHTPATH_GRAZING);
}

static void several_paths_from_behind(void **state)
{
	(void)state;
	// Coplanar light from all round, and from behind on the far side: every path that the scan finds, and no other.
	struct rng rng = { 9 };
	int several = 0;
	for (int i = 0; i < 1000; i++) {
		bool behind = i & 1;
		double P[3] = { behind ? rng_range(&rng, -4.5, -3) : rng_range(&rng, -5, 5), 0, 3.3 };
		double a = (behind ? rng_range(&rng, 90, 115) : rng_range(&rng, -135, 135)) * M_PI / 180;
		double w[3] = { sin(a), 0, -cos(a) }, all[8][3], scan[8][3];
		int n = lightpath_all(all, 8, &generic, P, 0, w), m = light_case_bracketed(scan, 8, &generic, P, 0, w);
		several += m > 1;
		for (int k = 0; k < m; k++) {
			double least = INFINITY;
			for (int j = 0; j < n; j++)
				least = fmin(least, gap(all[j], scan[k]));
			check(least < 1e-10, "a path that the search does not find", least);
		}
		for (int j = 0; j < n; j++)
			check(light_case_snell(&generic, P, 0, w, all[j]) < 1e-12, "a path that is none", all[j][0]);
	}
	assert_true(several > 20);
	// The limit: with the iris 3.3 mm deep one path up to 92 degrees from the axis; lower where the light has further to go.
	check(fabs(lightpath_clear_depth(&generic) - 3.33) < 0.02, "clear depth", lightpath_clear_depth(&generic));
}

enum { N = 20001 };
struct soa {
	float p[3][N], w[3][N], k[3][N];
	double P[3][N], W[3][N], K[3][N];
	struct light_case c[N];
	unsigned char status[N];
};

static void batches(void **state)
{
	(void)state;
	struct soa *s = mem_new(1, sizeof *s);
	struct rng rng = { 77 };
	const struct light_range range = { false, { 2.7, 3.3 }, 5.7, 90, { 0, 89.9 } };
	for (int i = 0; i < N; i++) {
		light_case_draw(&s->c[i], &rng, &range);
		for (int k = 0; k < 3; k++) {
			s->p[k][i] = s->P[k][i] = s->c[i].P[k];
			s->w[k][i] = s->W[k][i] = s->c[i].w[k];
		}
	}
	lightpath_batch_double(N, s->P[0], s->P[1], s->P[2], s->W[0], s->W[1], s->W[2], s->K[0], s->K[1], s->K[2], s->status,
	                       &generic, 4);
	for (int i = 0; i < N; i++) {
		double K[3] = { s->K[0][i], s->K[1][i], s->K[2][i] }, spread = s->c[i].spread[0];
		assert_int_equal(s->status[i], LIGHTPATH_OK);
		enum light_verdict verdict = light_case_judge(&s->c[i], false, K, fmax(2e-12, 4e-15 * spread * (1 + 1e-3 * spread)));
		assert_true(verdict != LIGHT_WRONG);
	}
	lightpath_batch(N, s->p[0], s->p[1], s->p[2], s->w[0], s->w[1], s->w[2], s->k[0], s->k[1], s->k[2], s->status, &generic, 3);
	for (int i = 0; i < N; i++) {
		// Against the solver at the same float inputs: 2e-5 mm is the bar; what lies nearer to a focus than spread 50
		// may settle on its other side.
		double P[3] = { s->p[0][i], s->p[1][i], s->p[2][i] }, w[3] = { s->w[0][i], s->w[1][i], s->w[2][i] }, K[3];
		if (lightpath_solve_directional(K, &generic, P, w) != LIGHTPATH_OK || s->c[i].spread[0] > 50)
			continue;
		double e = gap(K, (double[]){ s->k[0][i], s->k[1][i], s->k[2][i] });
		assert_true(s->status[i] == LIGHTPATH_OK || s->c[i].cos_i < 1e-5 || hypot(K[0], K[1]) > 5.8499);
		check(e <= 2e-5, "float K", e);
	}
	double C[3] = { 20, -30, -70 };
	lightpath_batch_point(N, s->p[0], s->p[1], s->p[2], C, s->k[0], s->k[1], s->k[2], s->status, &generic, 3);
	for (int i = 0; i < N; i++) {
		double P[3] = { s->p[0][i], s->p[1][i], s->p[2][i] }, K[3];
		enum lightpath_status status = lightpath_solve(K, &generic, P, C);
		if (fabs(hypot(K[0], K[1]) - 5.85) > 1e-4)
			assert_int_equal(status, s->status[i]);
		double e = gap(K, (double[]){ s->k[0][i], s->k[1][i], s->k[2][i] });
		check(status != LIGHTPATH_OK || e <= 2e-5, "float K to a point", e);
	}
	free(s);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(on_the_axis),
		cmocka_unit_test(a_straight_line_without_a_step_of_index),
		cmocka_unit_test(a_sphere_keeps_radii),
		cmocka_unit_test(an_aplanatic_sphere),
		cmocka_unit_test(against_a_bracketed_solve),
		cmocka_unit_test(random_cases),
		cmocka_unit_test(there_and_back),
		cmocka_unit_test(no_number_comes_of_no_problem),
		cmocka_unit_test(several_paths_from_behind),
		cmocka_unit_test(batches),
	};
	return cmocka_run_group_tests(tests, 0, 0);
}
