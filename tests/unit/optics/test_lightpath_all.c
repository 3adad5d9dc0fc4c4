/* Light paths that are easily missed: several at once, near a focus, in slivers of the cornea, beside a stationary point
 * that is none. */
#include "tests/lib/unit.h"

#include "base/mem.h"
#include "optics/lightpath/lightpath.h"
#include "tests/lib/truth/light_case.h"

static double gap(const double a[3], const double b[3])
{
	return hypot(hypot(a[0] - b[0], a[1] - b[1]), a[2] - b[2]);
}

static double gap_to_any(const double K[3], int n, const double all[][3])
{
	double least = INFINITY;
	for (int i = 0; i < n; i++)
		least = fmin(least, gap(K, all[i]));
	return least;
}

/* Coplanar problems of any cornea: every path that a scan in long double finds, and none that breaks the law. */
static void every_path_of_any_cornea(void **state)
{
	(void)state;
	const struct light_range range = { true, { 2.5, 5 }, 6, 135, { 0, 89.9 } };
	struct rng rng = { 21 };
	int several = 0;
	for (int i = 0; i < 1500; i++) {
		struct light_case c;
		light_case_draw(&c, &rng, &range);
		// Half of them with light from behind, focused on the far side.
		bool behind = i % 4 < 2;
		double a = (behind ? rng_range(&rng, 80, 112) : rng_range(&rng, -130, 130)) * M_PI / 180;
		double r = behind ? -rng_range(&rng, 0.5, 0.85) * c.cornea.rim : hypot(c.P[0], c.P[1]), away = pow(10, rng_range(&rng, 0.3, 5));
		double P[3] = { r, 0, c.P[2] }, w[3] = { sin(a), 0, -cos(a) }, C[3] = { w[0] * away, 0, w[2] * away }, scan[8][3], all[8][3];
		bool outside = C[0] * C[0] + C[2] * (c.cornea.p * C[2] - 2 * c.cornea.R) > 0.5;
		const double *near = i % 2 && outside ? C : 0;
		int n = lightpath_all(all, COUNT(all), &c.cornea, P, near, w);
		int m = light_case_bracketed(scan, COUNT(scan), &c.cornea, P, near, w);
		several += m > 1;
		for (int k = 0; k < m; k++)
			if (!(gap_to_any(scan[k], n, all) < 1e-9))
				fail_msg("problem %d: the path through %.17g is overlooked", i, scan[k][0]);
		for (int k = 0; k < n; k++)
			assert_true(light_case_snell(&c.cornea, P, near, w, all[k]) < 1e-12);
	}
	assert_true(several > 5);
}

/* The path that a case was built from is among all, up to the focus, where it and its twin are one. */
static void none_is_overlooked(void **state)
{
	(void)state;
	static const struct light_range ranges[] = { { false, { 2.5, 5 }, 5.85, 135, { 0, 89.9 } },
		                                     { true, { 2.5, 5 }, 6, 90, { 88, 89.9 } },
		                                     { true, { 2.5, 5 }, 8, 135, { 0, 89.9 } } };
	struct rng rng = { 77 };
	for (int i = 0; i < 30000; i++) {
		struct light_case c;
		double all[16][3];
		light_case_draw(&c, &rng, &ranges[i % COUNT(ranges)]);
		const double *C = i & 1 ? c.C : 0;
		int n = lightpath_all(all, COUNT(all), &c.cornea, c.P, C, c.w);
		// The inputs' rounding, 1e-15, over the flatness of L.
		if (!(gap_to_any(c.K, n, all) < fmax(1e-12, 4e-15 * c.spread[i & 1])))
			fail_msg("case %d: %.1e mm, spread %g", i, gap_to_any(c.K, n, all), c.spread[i & 1]);
		for (int k = 1; k < n; k++)
			assert_true(gap(all[k - 1], all[k]) > 1e-7);
	}
}

struct problem {
	struct cornea cornea;
	double P[3], from[3];
	bool is_point;
	double K[3];
};

/* Problems whose first step leads to a stationary point that is no path. */
static const struct problem misleading[] = {
	{ { .R = 7.7999999999999998, .p = 0.75, .n = 1.3360000000000001, .rim = 5.8499999999999996 },
	  { -4.7492494706893389, -0.74161418232156728, 4.9356178870691103 },
	  { 184.98671978540307, 18.652782007269646, -7.9026446519115856 }, true,
	  { 5.0780251396301734, 0.089759623704285793, 1.8112007908566232 } },
	{ { .R = 7.7999999999999998, .p = 0.75, .n = 1.3360000000000001, .rim = 5.8499999999999996 },
	  { -3.865231740124627, 3.0818143177075621, 4.6896830863252745 },
	  { 0.99143620616104511, -0.12325699163819891, 0.043150470742444859 }, false,
	  { 3.9296395899276262, 4.1040269907228444, 2.3307253400988732 } },
	{ { .R = 6.5463713225058058, .p = 0.97486418002516229, .n = 1.2656309191149087, .rim = 6.497625174454118 },
	  { 2.680779628820404, -3.5950062802267464, 4.0967085864937349 },
	  { -77.012913745495666, 55.16557955863761, -24.005139565573973 }, true,
	  { -2.3820869246092506, -0.72632411078569226, 0.4916897068723875 } },
	{ { .R = 7.095209010224945, .p = 1.1230881069406073, .n = 1.1075510151262702, .rim = 6.5612162973252177 },
	  { 4.6594298383328292, 2.2125280503018345, 3.3435121856135064 },
	  { -0.83953512006695774, -0.3986528538492351, -0.36912963074239807 }, false, { 0, 0, 0 } },
};

static void a_step_past_the_path_is_taken_back(void **state)
{
	(void)state;
	for (int i = 0; i < COUNT(misleading); i++) {
		const struct problem *p = &misleading[i];
		const double *P = p->P, *w = p->from;
		double K[3];
		float Pf[3] = { (float)P[0], (float)P[1], (float)P[2] }, wf[3] = { (float)w[0], (float)w[1], (float)w[2] }, k[3];
		unsigned char status, status_f;
		if (p->is_point) {
			lightpath_batch_point_double(1, P, P + 1, P + 2, w, K, K + 1, K + 2, &status, &p->cornea, 6);
			lightpath_batch_point(1, Pf, Pf + 1, Pf + 2, w, k, k + 1, k + 2, &status_f, &p->cornea, 4);
		} else {
			lightpath_batch_double(1, P, P + 1, P + 2, w, w + 1, w + 2, K, K + 1, K + 2, &status, &p->cornea, 6);
			lightpath_batch(1, Pf, Pf + 1, Pf + 2, wf, wf + 1, wf + 2, k, k + 1, k + 2, &status_f, &p->cornea, 4);
		}
		assert_int_equal(status, LIGHTPATH_OK);
		assert_int_equal(status_f, LIGHTPATH_OK);
		assert_true(gap(K, p->K) < 1e-12);
		assert_true(gap((double[]){ (double)k[0], (double)k[1], (double)k[2] }, p->K) < 2e-5);
	}
}

/* A path inside the rim beside a shorter one that is blocked beyond it. */
static void a_path_beside_a_blocked_one(void **state)
{
	(void)state;
	struct cornea c = { .R = 6.0768096095689081, .p = 0.61737064926019691, .n = 1.1340899759682646, .rim = 4.1065165172306335 };
	const double P[3] = { -0.61486217800137977, 5.1140871079927566, 3.9497652292448122 };
	const double C[3] = { -1502.1509067296715, -3228.4173389802418, -1566.0952924212243 };
	double K[3];
	assert_int_equal(lightpath_solve(K, &c, P, C), LIGHTPATH_OK);
	assert_true(hypot(K[0], K[1]) <= c.rim && light_case_snell(&c, P, C, 0, K) < 1e-14);
}

/* On the axis of a sphere, behind the focus of its margin, a ring of paths meets: not all squares there can be looked at. */
static void a_ring_of_paths_ends(void **state)
{
	(void)state;
	struct cornea c = { .R = 7.8, .p = 1, .n = 2, .rim = 7 };
	// The rays at 5 mm from the axis cross it here.
	double r = 5, sin_i = r / c.R, i = asin(sin_i), t = asin(sin_i / c.n);
	double P[3] = { 0, 0, c.R - c.R * cos(i) + r / tan(i - t) }, K[16][3];
	int n = lightpath_all(K, COUNT(K), &c, P, 0, (double[]){ 0, 0, -1 });
	assert_true(n > 1);
	for (int k = 0; k < n; k++)
		assert_true(hypot(K[k][0], K[k][1]) < 1e-9 || fabs(hypot(K[k][0], K[k][1]) - r) < 1e-9);
}

/* A rim beyond the equator, as the camera's own rays have it, ends at the equator, wherever rounding puts that. */
static void a_cornea_to_its_equator(void **state)
{
	(void)state;
	struct rng rng = { 33 };
	for (int i = 0; i < 2000; i++) {
		struct cornea whole = { .R = rng_range(&rng, 7, 8.5), .p = rng_range(&rng, 0.6, 1), .n = 1.336, .rim = 1000 }, cut = whole;
		cut.rim = cornea_edge(&whole) * (1 - 1e-9);
		assert_float_equal(cornea_depth(&whole, cornea_edge(&whole)), whole.R / whole.p, 1e-6);
		double P[3] = { -5, 4, 3.3 }, a = rng_range(&rng, 80, 110) * M_PI / 180, w[3] = { sin(a), 0, -cos(a) }, K[4][3], L[4][3];
		int n = lightpath_all(K, 4, &whole, P, 0, w), m = lightpath_all(L, 4, &cut, P, 0, w);
		assert_int_equal(n, m);
		for (int k = 0; k < n; k++)
			assert_true(gap(K[k], L[k]) < 1e-9);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(every_path_of_any_cornea),
		cmocka_unit_test(none_is_overlooked),
		cmocka_unit_test(a_step_past_the_path_is_taken_back),
		cmocka_unit_test(a_path_beside_a_blocked_one),
		cmocka_unit_test(a_ring_of_paths_ends),
		cmocka_unit_test(a_cornea_to_its_equator),
	};
	return cmocka_run_group_tests(tests, 0, 0);
}
