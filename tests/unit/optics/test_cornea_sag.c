/* cornea_sag: derivatives against differences, a surface of revolution against the closed solver, and light paths through
 * asymmetric corneas built forwards, by Snell alone. */
#include "tests/lib/unit.h"

#include <math.h>
#include <string.h>

#include "base/mem.h"
#include "math/rng.h"
#include "math/vec.h"
#include "tests/peers/cornea_sag.h"

static const struct cornea generic = { .R = 7.8, .p = 0.75, .n = 1.336, .rim = 5.85 };

/* 4 dioptres of astigmatism at 25 degrees, tilted by 3 and -2 degrees, the apex 0.3 mm off, and 20 um of trefoil. */
static struct cornea_sag odd(void)
{
	struct cornea_sag c = cornea_sag_toric(&generic, 7.15, 25 * M_PI / 180, (double[]){ 0.052, -0.035 }, (double[]){ 0.3, -0.1 });
	c.term[5] += 0.02;
	c.term[7] -= 0.06;
	return c;
}

static void derivatives(void **state)
{
	(void)state;
	struct cornea_sag c = odd();
	struct rng rng = { 4 };
	const double h = 1e-4;
	for (int i = 0; i < 200; i++) {
		double x = rng_range(&rng, -4, 4), y = rng_range(&rng, -4, 4), g[2], b[3], a[2][2], n[2];
		cornea_sag_depth(&c, x, y, g, b);
		NEAR(g[0], (cornea_sag_depth(&c, x + h, y, a[0], 0) - cornea_sag_depth(&c, x - h, y, a[1], 0)) / (2 * h), 1e-8);
		NEAR(b[0], (a[0][0] - a[1][0]) / (2 * h), 1e-8);
		NEAR(b[1], (a[0][1] - a[1][1]) / (2 * h), 1e-8);
		n[0] = cornea_sag_depth(&c, x, y + h, a[0], 0);
		n[1] = cornea_sag_depth(&c, x, y - h, a[1], 0);
		NEAR(g[1], (n[0] - n[1]) / (2 * h), 1e-8);
		NEAR(b[2], (a[0][1] - a[1][1]) / (2 * h), 1e-8);
	}
}

/* The meridians of a toric cornea have the radii asked for, at the apex. */
static void toric_radii(void **state)
{
	(void)state;
	const double none[2] = { 0 }, axis = 0.4;
	struct cornea_sag c = cornea_sag_toric(&generic, 7.2, axis, none, none);
	double b[3];
	cornea_sag_depth(&c, 0, 0, 0, b);
	double u = cos(axis), v = sin(axis);
	NEAR(u * u * b[0] + 2 * u * v * b[1] + v * v * b[2], 1 / 7.2, 1e-12);
	NEAR(v * v * b[0] - 2 * u * v * b[1] + u * u * b[2], 1 / 7.8, 1e-12);
}

/* Forward: a point of the cornea, a direction, Snell, the iris plane. Returns false where it misses the iris. */
static bool forward(double P[3], double w[3], double K[3], const struct cornea_sag *c, struct rng *rng)
{
	double N[3], in[3], t, r = 5.8 * sqrt(rng_uniform(rng)), a = rng_range(rng, 0, 2 * M_PI), z = -rng_uniform(rng), b = rng_range(rng, 0, 2 * M_PI);
	K[0] = r * cos(a);
	K[1] = r * sin(a);
	K[2] = cornea_sag_depth(c, K[0], K[1], 0, 0);
	w[0] = sqrt(1 - z * z) * cos(b);
	w[1] = sqrt(1 - z * z) * sin(b);
	w[2] = z;
	cornea_sag_normal(N, c, K[0], K[1]);
	if (vec_dot(w, N) < 1e-3 || !refract(in, (double[]){ -w[0], -w[1], -w[2] }, N, 1, c->base.n))
		return false;
	t = (3.3 - K[2]) / in[2];
	vec_add(P, K, t, in);
	return t > 0 && hypot(P[0], P[1]) < 5.8;
}

/* How far the ray that enters at K passes by P on its plane. */
static double miss(const struct cornea_sag *c, const double P[3], const double w[3], const double K[3])
{
	double N[3], in[3];
	cornea_sag_normal(N, c, K[0], K[1]);
	if (!refract(in, (double[]){ -w[0], -w[1], -w[2] }, N, 1, c->base.n))
		return INFINITY;
	double t = (P[2] - K[2]) / in[2];
	return hypot(K[0] + t * in[0] - P[0], K[1] + t * in[1] - P[1]);
}

static void paths_built_forwards(void **state)
{
	(void)state;
	struct cornea_sag c = odd();
	struct rng rng = { 6 };
	int others = 0;
	for (int i = 0; i < 5000;) {
		double P[3], w[3], K[3], got[3];
		if (!forward(P, w, K, &c, &rng))
			continue;
		i++;
		assert_int_equal(cornea_sag_path(got, &c, P, w, 12), LIGHTPATH_OK);
		double e = hypot(hypot(got[0] - K[0], got[1] - K[1]), got[2] - K[2]);
		// Double, with a lever of some hundred near a focus; there and beyond it another path may be as good.
		others += e >= 1e-9;
		if (!(e < 1e-9) && !(miss(&c, P, w, got) < 1e-9))
			fail_msg("K %g %g, w %g %g %g: off by %g mm, passes by %g", K[0], K[1], w[0], w[1], w[2], e, miss(&c, P, w, got));
	}
	assert_true(others < 10);
}

static void a_surface_of_revolution(void **state)
{
	(void)state;
	const double none[2] = { 0 };
	struct cornea_sag c = cornea_sag_toric(&generic, generic.R, 0, none, none);
	double P[3] = { 2, -3, 3.3 }, w[3] = { 0.6, 0.5, 0 }, K[3], truth[3];
	w[2] = -sqrt(1 - w[0] * w[0] - w[1] * w[1]);
	assert_int_equal(lightpath_solve_directional(truth, &generic, P, w), LIGHTPATH_OK);
	assert_int_equal(cornea_sag_path(K, &c, P, w, 3), LIGHTPATH_OK);
	for (int k = 0; k < 3; k++)
		NEAR(K[k], truth[k], 1e-12);
	// No point inside: no path, and no number that is none.
	assert_int_equal(cornea_sag_path(K, &c, (double[]){ 0, 0, -5 }, w, 3), LIGHTPATH_NONE);
	assert_true(isfinite(K[0] + K[1] + K[2]));
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(derivatives),
		cmocka_unit_test(toric_radii),
		cmocka_unit_test(paths_built_forwards),
		cmocka_unit_test(a_surface_of_revolution),
	};
	return cmocka_run_group_tests(tests, 0, 0);
}
