/* The cornea: closed forms, and the batches against single rays. */
#include "base/mem.h"
#include "math/rng.h"
#include "math/vec.h"
#include "optics/cornea/cornea.h"
#include "tests/lib/unit.h"
#include "tests/peers/fresnel.h"

static const struct cornea generic = { .R = 7.8, .p = 0.75, .n = 1.336, .rim = 5.85, .R_post = 6.5, .p_post = 0.75,
	                               .thickness = 0.55, .n_cornea = 1.376 };

static void near(double got, double want, double tolerance)
{
	if (!(fabs(got - want) <= tolerance))
		fail_msg("%.17g, should be %.17g within %g", got, want, tolerance);
}

static void depth_in_closed_form(void **state)
{
	(void)state;
	// The paper's own check: 2.64 mm deep at radius 6 mm.
	near(cornea_depth(&generic, 6), 2.64, 0.005);
	struct cornea sphere = { .R = 7.8, .p = 1, .n = 1.336, .rim = 7 }, paraboloid = { .R = 7.8, .p = 0, .n = 1.336, .rim = 7 };
	near(cornea_depth(&sphere, 5), 7.8 - sqrt(7.8 * 7.8 - 25), 1e-14);
	near(cornea_depth(&paraboloid, 5), 25 / 15.6, 1e-15);
	assert_true(isnan(cornea_depth(&generic, 9.1)));  // past the equator at R / sqrt(p) = 9.007
	near(cornea_edge(&(struct cornea){ .R = 5, .p = 2, .rim = 6 }), 5 / sqrt(2), 1e-15);
}

static void normal_is_the_gradient(void **state)
{
	(void)state;
	double N[3];
	cornea_normal(N, &generic, (double[]){ 0, 0, 0 });
	near(N[2], -1, 0);
	// Against differences of the depth: the slope is x / s. Central differences of 1e-4 mm: 1e-9.
	double K[3] = { 3, -2, cornea_depth(&generic, hypot(3, 2)) }, h = 1e-4;
	cornea_normal(N, &generic, K);
	near(-N[0] / N[2], (cornea_depth(&generic, hypot(3 + h, 2)) - cornea_depth(&generic, hypot(3 - h, 2))) / (2 * h), 1e-8);
	near(vec_norm(N), 1, 1e-15);
}

static void snell_at_known_angles(void **state)
{
	(void)state;
	double out[3], N[3] = { 0, 0, -1 };
	// Air into cornea at 30 degrees, and at 90: the critical angle.
	for (int deg = 30; deg <= 90; deg += 60) {
		double a = deg * M_PI / 180;
		assert_true(refract(out, (double[]){ sin(a), 0, cos(a) }, N, 1, 1.376));
		near(asin(out[0]), asin(sin(a) / 1.376), 1e-15);
		near(vec_norm(out), 1, 1e-15);
	}
	// Water to air beyond the critical angle of 48.5 degrees.
	assert_false(refract(out, (double[]){ sin(0.9), 0, cos(0.9) }, N, 1.336, 1));
}

static void fresnel_in_closed_form(void **state)
{
	(void)state;
	near(fresnel_transmittance(1, 1, 1.336), 4 * 1.336 / (2.336 * 2.336), 1e-15);
	near(fresnel_transmittance(0, 1, 1.336), 0, 1e-15);
	near(fresnel_transmittance(0.5, 1, 1), 1, 1e-15);
	near(fresnel_transmittance(0.6, 1.336, 1), 0, 0);  // 53 degrees: total reflection
	// Reversible: the same from the other side.
	double t = sqrt(1 - 0.75 / (1.336 * 1.336));
	near(fresnel_transmittance(0.5, 1, 1.336), fresnel_transmittance(t, 1.336, 1), 1e-15);
	// Brewster's angle: one polarisation is not reflected; R = ½ ((n² − 1)/(n² + 1))².
	double n = 1.336, r = (n * n - 1) / (n * n + 1);
	near(fresnel_transmittance(cos(atan(n)), 1, n), 1 - 0.5 * r * r, 1e-15);
}

static void a_ray_on_the_axis_goes_straight(void **state)
{
	(void)state;
	for (int two = 0; two < 2; two++) {
		struct cornea c = generic;
		c.two_surface = two;
		double K[3], from[3], in[3];
		assert_true(cornea_sight(K, from, in, &c, (double[]){ 0, 0, -80 }, (double[]){ 0, 0, 1 }));
		near(vec_norm(K), 0, 1e-15);
		near(from[2], two ? 0.55 : 0, 1e-15);
		near(in[2], 1, 1e-15);
	}
}

static void a_sphere_keeps_rays_through_its_centre(void **state)
{
	(void)state;
	// p = 1: rays aimed at the centre meet the surface head on, on both surfaces of a concentric meniscus.
	struct cornea c = { .R = 7.8, .p = 1, .n = 1.336, .rim = 6, .two_surface = true, .R_post = 7.25, .p_post = 1,
		            .thickness = 0.55, .n_cornea = 1.376 };
	double o[3] = { 30, -20, -60 }, to[3] = { -30, 20, 67.8 }, K[3], from[3], in[3], unit[3];
	vec_unit(unit, to);
	assert_true(cornea_sight(K, from, in, &c, o, to));
	for (int i = 0; i < 3; i++)
		near(in[i], unit[i], 1e-14);
	near(hypot(hypot(from[0], from[1]), from[2] - 7.8), 7.25, 1e-14);
}

static void an_aplanatic_sphere_focuses_without_error(void **state)
{
	(void)state;
	// Rays aimed at the point R n behind the centre meet, all of them, at R / n behind it (Weierstrass).
	struct cornea c = { .R = 7.8, .p = 1, .n = 1.336, .rim = 7.5 };
	double far = 7.8 + 7.8 * 1.336, near_z = 7.8 + 7.8 / 1.336;
	for (int i = 1; i < 20; i++) {
		double o[3] = { 3.0 * i, -i, -100 }, to[3] = { -o[0], -o[1], far - o[2] }, K[3], from[3], in[3];
		assert_true(cornea_sight(K, from, in, &c, o, to));
		double t = (near_z - from[2]) / in[2];
		near(hypot(from[0] + t * in[0], from[1] + t * in[1]), 0, 1e-13);
	}
}

static void nothing_bends_without_a_step_of_index(void **state)
{
	(void)state;
	struct cornea c = generic;
	c.n = 1;
	double o[3] = { 40, 10, -70 }, to[3] = { -38, -8, 73 }, K[3], from[3], in[3], unit[3];
	vec_unit(unit, to);
	assert_true(cornea_sight(K, from, in, &c, o, to));
	for (int i = 0; i < 3; i++)
		near(in[i], unit[i], 1e-15);
}

static void rays_miss_where_there_is_no_cornea(void **state)
{
	(void)state;
	double K[3];
	assert_false(cornea_hit(K, &generic, (double[]){ 6, 0, -80 }, (double[]){ 0, 0, 1 }));   // beyond the rim
	assert_false(cornea_hit(K, &generic, (double[]){ 0, 0, -80 }, (double[]){ 0, 0, -1 }));  // away from the eye
	assert_false(cornea_hit(K, &generic, (double[]){ 0, 0, 3 }, (double[]){ 0, 0, -1 }));    // from inside
	assert_false(cornea_hit(K, &generic, (double[]){ 0, 0, 40 }, (double[]){ 0, 0, -1 }));   // through the back
	assert_true(cornea_hit(K, &generic, (double[]){ 0, 0, -1e7 }, (double[]){ 0, 0, 1 }));
	near(vec_norm(K), 0, 1e-15);
	// A paraboloid met along its axis, and at 10 km off the axis: input digits of 1e-9 mm.
	struct cornea paraboloid = { .R = 7.8, .p = 0, .n = 1.336, .rim = 6 };
	assert_true(cornea_hit(K, &paraboloid, (double[]){ 3, 0, -50 }, (double[]){ 0, 0, 1 }));
	near(K[2], 9 / 15.6, 1e-14);
	assert_true(cornea_hit(K, &generic, (double[]){ 1e7, 0, -1e7 }, (double[]){ -1, 0, 1 }));
	near(K[0] * K[0] - 2 * 7.8 * K[2] + 0.75 * K[2] * K[2], 0, 1e-12);
}

/* The batch against the one ray, both corneas: stored in float, so half a unit in the last place of 8 mm, 4.8e-7. */
static void batches_agree_with_single_rays(void **state)
{
	(void)state;
	enum { N = 10007 };
	static float d[3][N], k[3][N], f[3][N], in[3][N], q[2][N];
	static unsigned char hit[N];
	struct rng rng = { 3 };
	double o[3] = { 15, -25, -75 };
	for (int i = 0; i < N; i++) {
		double to[3] = { rng_range(&rng, -9, 9) - o[0], rng_range(&rng, -9, 9) - o[1], 1 - o[2] };
		vec_unit(to, to);
		for (int j = 0; j < 3; j++)
			d[j][i] = to[j];
	}
	for (int two = 0; two < 2; two++) {
		struct cornea c = generic;
		c.two_surface = two;
		cornea_sight_batch(&(struct sight_rays){ N, d[0], d[1], d[2], k[0], k[1], k[2], f[0], f[1], f[2], in[0], in[1],
		                                         in[2], hit }, &c, o);
		cornea_sight_plane(N, d[0], d[1], d[2], q[0], q[1], 3.3, &c, o);
		int hits = 0;
		for (int i = 0; i < N; i++) {
			double K[3], from[3], inside[3];
			bool one = cornea_sight(K, from, inside, &c, o, (double[]){ d[0][i], d[1][i], d[2][i] });
			assert_int_equal(hit[i], one);
			assert_int_equal(isnan(q[0][i]), !one);
			if (!one)
				continue;
			hits++;
			double t = (3.3 - from[2]) / inside[2];
			for (int j = 0; j < 3; j++) {
				near(k[j][i], K[j], 5e-7);
				near(f[j][i], from[j], 5e-7);
				near(in[j][i], inside[j], 1e-7);
			}
			near(q[0][i], from[0] + t * inside[0], 1e-6);
			near(q[1][i], from[1] + t * inside[1], 1e-6);
		}
		assert_in_range(hits, 2000, N - 2000);
	}
}

static void one_surface_stands_for_two(void **state)
{
	(void)state;
	// How far apart the two models see the iris, camera 80 mm away and 30 degrees off: the known 0.008 to 0.05 mm.
	struct cornea two = generic;
	two.two_surface = true;
	double o[3] = { 40, 0, -66 }, sum = 0, worst = 0;
	int n = 0;
	for (int i = 0; i < 400; i++) {
		double a = i * 2.399963, r = 5.0 * sqrt((i + 0.5) / 400), d[3] = { r * cos(a) - o[0], r * sin(a) - o[1], 2 - o[2] };
		double K[3], f1[3], f2[3], d1[3], d2[3], q[3];
		if (!cornea_sight(K, f1, d1, &generic, o, d) || !cornea_sight(K, f2, d2, &two, o, d))
			continue;
		for (int j = 0; j < 2; j++)
			q[j] = f1[j] + (3.3 - f1[2]) / d1[2] * d1[j] - f2[j] - (3.3 - f2[2]) / d2[2] * d2[j];
		sum += hypot(q[0], q[1]);
		worst = fmax(worst, hypot(q[0], q[1]));
		n++;
	}
	assert_in_range(n, 300, 400);
	assert_true(sum / n > 0.004 && sum / n < 0.025);
	assert_true(worst < 0.06);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(depth_in_closed_form),
		cmocka_unit_test(normal_is_the_gradient),
		cmocka_unit_test(snell_at_known_angles),
		cmocka_unit_test(fresnel_in_closed_form),
		cmocka_unit_test(a_ray_on_the_axis_goes_straight),
		cmocka_unit_test(a_sphere_keeps_rays_through_its_centre),
		cmocka_unit_test(an_aplanatic_sphere_focuses_without_error),
		cmocka_unit_test(nothing_bends_without_a_step_of_index),
		cmocka_unit_test(rays_miss_where_there_is_no_cornea),
		cmocka_unit_test(batches_agree_with_single_rays),
		cmocka_unit_test(one_surface_stands_for_two),
	};
	return cmocka_run_group_tests(tests, 0, 0);
}
