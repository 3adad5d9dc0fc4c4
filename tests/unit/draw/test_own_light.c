/* own_light: what belongs to the photograph's light and what to the iris, on colours whose parts are known. */
#include "draw/eye/own_light.h"

#include <math.h>

#include "base/mem.h"
#include "tests/lib/scenes/plain_scene.h"

static const float dim = 0.2f;               // the model, everywhere
static const double fibre = 0.1, wave = 24;  // ln amplitude; radians a mm: a period of 0.26 mm

/* A light that falls off across the iris, a hue that does, too, and fibres. */
static double slope_ln(double x) { return 0.15 * x; }
static double hue_ln(double y) { return 0.05 * y; }
static double fibre_ln(double x) { return fibre * sin(wave * x); }

static double place(const struct scene *s, int i) { return (i + 0.5) / s->level[0].per_mm - s->extent; }

/* Far from the pupil and from the limbus: no ring without colours is mixed in. */
static bool inner(double x, double y) { return hypot(x, y) > 3 && hypot(x, y) < 4.6; }

static float *texel(const struct scene *s, int x, int y) { return s->level[0].colour + 4 * ((long)y * s->level[0].n + x); }

static const float own_mean[3] = { 0.3f, -0.5f, -0.6f };

/* What changes with the distance from the pupil alone. */
static double ring_ln(double r) { return cos(2 * (r - 3)); }

/* The scene with these colours; spot: so many times brighter within 0.05 mm of (4, 0); rings: so much of ring_ln besides. */
static void lit(struct scene *s, double spot, double rings)
{
	struct scene_conf conf = conf_of(4);
	conf.albedo_mm = 0.4;
	conf.albedo_most = 4;
	struct err err = { 0 };
	assert_true(painted_scene(s, 512, &plain_eye, &conf, even, 0, 1.5, &err));
	struct scene_level *l = &s->level[0];
	const int n = l->n;
	l->model = mem_array(4 * (size_t)n * (size_t)n, sizeof *l->model);
	s->gain = 1;
	for (int y = 0; y < n; y++)
		for (int x = 0; x < n; x++) {
			double u = place(s, x), v = place(s, y), ln = slope_ln(u) + fibre_ln(u) + rings * ring_ln(hypot(u, v));
			for (int c = 0; c < 3; c++) {
				l->model[4 * ((long)y * n + x) + c] = dim;
				texel(s, x, y)[c] = dim * (float)exp(ln + (c - 1) * hue_ln(v)) * (hypot(u - 4, v) < 0.05 ? (float)spot : 1);
			}
		}
	const struct scene_beams beams = { .mean = { own_mean[0], own_mean[1], own_mean[2] } };
	scene_own_light_make(s, &beams);
}

/* Light and albedo together are the photograph; the hue and the fibres are all the iris'. */
static void parts_are_told_apart(void **state)
{
	(void)state;
	struct scene s;
	lit(&s, 1, 0);
	double cross = 0, square = 0, worst_slope = 0;
	for (int y = 0; y < s.level[0].n; y++)
		for (int x = 0; x < s.level[0].n; x++) {
			double u = place(&s, x), v = place(&s, y);
			if (!inner(u, v))
				continue;
			const float *left = texel(&s, x, y), own = scene_own_light_at(&s, 1, (float)u, (float)v);
			assert_float_equal(own * left[1], dim * exp(slope_ln(u) + fibre_ln(u)), 1e-4 * dim);
			assert_float_equal(log(left[2] / left[0]), 2 * hue_ln(v), 1e-4);
			// Of the slope a Gaussian keeps all, of fibres exp(-(wave sigma)^2 / 2), none; luminance bends ln by the hue's square.
			double rest = log(left[1] / dim);
			cross += rest * fibre_ln(u);
			square += fibre_ln(u) * fibre_ln(u);
			worst_slope = fmax(worst_slope, fabs(rest - fibre_ln(u)));
		}
	assert_true(square > 1);
	assert_float_equal(cross / square, 1, 0.02);
	// At the edges of the ring the mean over 0.4 mm sees one side alone: 0.15 a mm times a part of that.
	assert_true(worst_slope < 0.05);
	scene_free(&s);
}

/* What is alike all round the pupil stays with the iris, beside a light that is not. */
static void rings_are_the_iris(void **state)
{
	(void)state;
	struct scene s;
	lit(&s, 1, 0.3);
	double cross = 0, square = 0, light = 0, other = 0;
	for (int y = 0; y < s.level[0].n; y++)
		for (int x = 0; x < s.level[0].n; x++) {
			double u = place(&s, x), v = place(&s, y), ring = 0.3 * ring_ln(hypot(u, v));
			if (!inner(u, v))
				continue;
			double own = log((double)scene_own_light_at(&s, 1, (float)u, (float)v)), rest = log((double)texel(&s, x, y)[1] / (double)dim);
			cross += rest * ring;
			square += ring * ring;
			light += own * slope_ln(u);
			other += slope_ln(u) * slope_ln(u);
		}
	assert_true(square > 1);
	assert_float_equal(cross / square, 1, 0.05);
	assert_float_equal(light / other, 1, 0.05);
	scene_free(&s);
}

/* It shows in its own light, fades as another one's direction leaves it, and not at all where the light is elsewhere. */
static void only_its_own_light_shows_it(void **state)
{
	(void)state;
	struct scene s;
	lit(&s, 1, 0);
	assert_float_equal(scene_own_light_share(&s, own_mean), 1, 0);
	float last = 1;
	for (int i = 1; i <= 20; i++) {
		const float mean[3] = { own_mean[0] + 0.05f * (float)i, own_mean[1], own_mean[2] }, share = scene_own_light_share(&s, mean);
		assert_true(share < last);
		last = share;
	}
	assert_true(last < 1e-4);
	assert_float_equal(scene_own_light_at(&s, 0, 4, 0), 1, 0);
	assert_true(scene_own_light_at(&s, 1, 4, 0) > 1.3);
	scene_set_detail(&s, 0.5);
	float whole = scene_own_light_at(&s, 1, 4, 0);
	scene_set_detail(&s, 1);
	assert_float_equal(whole * whole, scene_own_light_at(&s, 1, 4, 0), 1e-4);
	scene_free(&s);
}

/* A fleck that no albedo explains is bounded; what is around it stays. */
static void albedo_is_bounded(void **state)
{
	(void)state;
	struct scene s;
	lit(&s, 100, 0);
	double most = 0;
	for (int y = 0; y < s.level[0].n; y++)
		for (int x = 0; x < s.level[0].n; x++)
			if (inner(place(&s, x), place(&s, y)))
				most = fmax(most, texel(&s, x, y)[1]);
	assert_float_equal(most, 4 * dim, 0.1 * dim);
	scene_free(&s);
}

/* Without albedo_mm all of the photograph is the iris': nothing is split. */
static void not_asked_for(void **state)
{
	(void)state;
	struct scene s;
	lit(&s, 1, 0);
	image_free(&s.own_light);
	s.conf.albedo_mm = 0;
	const float was = texel(&s, 400, 256)[0];
	scene_own_light_make(&s, &(struct scene_beams){ 0 });
	assert_float_equal(texel(&s, 400, 256)[0], was, 0);
	assert_float_equal(scene_own_light_share(&s, own_mean), 0, 0);
	scene_free(&s);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(parts_are_told_apart),
		cmocka_unit_test(rings_are_the_iris),
		cmocka_unit_test(only_its_own_light_shows_it),
		cmocka_unit_test(albedo_is_bounded),
		cmocka_unit_test(not_asked_for),
	};
	return cmocka_run_group_tests(tests, 0, 0);
}
