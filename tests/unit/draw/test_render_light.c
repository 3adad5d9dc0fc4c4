/* render: lights, their ways into the eye and the march against closed forms. */
#include "base/mem.h"
#include "bridge/imf_read.h"
#include "draw/eye/march/paths_flat.h"
#include "math/rng.h"
#include "math/vec.h"
#include "optics/lightpath/lightpath.h"
#include "tests/lib/bench/bench.h"
#include "tests/lib/scenes/plain_scene.h"
#include "tests/lib/unit.h"
#include "tests/peers/lightpath_gain.h"
#include "tests/peers/sclera_photons.h"

/* An even surrounding of radiance 1 gives every plane irradiance pi, whichever way that is reckoned. */
static void even_light(void **state)
{
	(void)state;
	struct envmap env = envmap_room(64, grey, grey, 1, 0, 0);
	assert_float_equal(envmap_level(&env), 1, 2e-3);  // the map's pixels are 2.8 degrees
	struct envmap_light lights[16];
	int n = envmap_lights(lights, 16, &env);
	double sum = 0;
	for (int i = 0; i < n; i++)
		sum += lights[i].rgb[1];
	assert_int_equal(n, 16);
	assert_float_equal(sum, 4, 1e-5);  // 4 pi over pi: no energy is lost
	struct rng rng = { 3 };
	for (int i = 0; i < 100; i++) {
		float d[3] = { (float)rng_normal(&rng), (float)rng_normal(&rng), (float)rng_normal(&rng) }, rgb[3];
		float len = sqrtf(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
		for (int c = 0; c < 3; c++)
			d[c] /= len;
		envmap_irradiance(rgb, &env, d);
		assert_float_equal(rgb[0], 1, 1e-3);  // light is summed over pixels of 2.8 degrees
		envmap_wet(rgb, &env, d);
		assert_float_equal(rgb[0], 1, 1e-3);
		envmap_at(rgb, &env, d, 0.5f);
		assert_float_equal(rgb[2], 1, 1e-4);
	}
	envmap_free(&env);
	// Whatever its light, scaled to 1 it is 1 in every direction, sharp and rough.
	env = envmap_room(64, (double[3]){ 30, 30, 30 }, (double[3]){ 30, 30, 30 }, 1, 0, 0);
	envmap_normalise(&env);
	for (int i = 0; i < 400; i++) {
		float d[3] = { (float)rng_normal(&rng), (float)rng_normal(&rng), (float)rng_normal(&rng) }, rgb[3];
		float len = sqrtf(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
		for (int c = 0; c < 3; c++)
			d[c] /= len;
		envmap_at(rgb, &env, d, (float)(i % 2));
		assert_float_equal(rgb[0], 1, 2e-3);  // the level itself is summed over pixels of 2.8 degrees
	}
	envmap_free(&env);
}

/* The white of the eye under one lamp, lit side, terminator and dark side, is what photons make of it: blue, green and red light, thin and thick shells. */
static void white_by_photons(void **state)
{
	(void)state;
	enum { ZONES = 36 };
	static const struct sclera_shell shell[] = { { 11.8, 0.6, 4.4, 0.06, 0.9, 1.336 }, { 11.8, 0.6, 3.0, 0.04, 0.9, 1.336 }, { 11.8, 0.9, 2.6, 0.02, 0.9, 1.336 }, { 11.8, 0.45, 2.6, 0.02, 0.8, 1.336 } };
	const double lamp[3] = { 0.6, -0.48, -0.64 }, dark[3] = { 0 };
	struct envmap_box box = { { lamp[0], lamp[1], lamp[2] }, { 0.03, 0.03 }, { 1000, 1000, 1000 }, 0 };
	struct envmap env = envmap_room(256, dark, dark, 1, 1, &box), twice = envmap_tinted(&env, (double[3]){ 1, 2, 0.5 });
	for (int k = 0; k < COUNT(shell); k++) {
		double truth[ZONES], mean = 0, worst = 0;
		assert_true(sclera_photons(truth, ZONES, &shell[k], 150000, 7 + (uint64_t)k) > 0.2);
		float seen[ZONES][3];
		for (int i = 0; i < ZONES; i++) {
			double t = M_PI * (i + 0.5) / ZONES, side[3], n[3], area = 0.5 * (cos(M_PI * i / ZONES) - cos(M_PI * (i + 1) / ZONES));
			vec_cross(side, lamp, (double[3]){ 0, 0, 1 });
			vec_unit(side, side);
			for (int c = 0; c < 3; c++)
				n[c] = cos(t) * lamp[c] + sin(t) * side[c];
			float normal[3] = { (float)n[0], (float)n[1], (float)n[2] }, other[3];
			envmap_wet(seen[i], &env, normal);
			envmap_wet(other, &twice, normal);
			assert_float_equal(other[1], 2 * seen[i][1], 1e-5 * seen[i][1]);
			mean += area * (double)seen[i][1];
		}
		for (int i = 0; i < ZONES; i++) {
			worst = fmax(worst, fabs(seen[i][1] / mean - truth[i]) / truth[1]);  // of what the lamp gives overhead: the first zone has few photons
		}
		print_message("white, %.2f mm, %.1f/mm: off by %.3f of the light overhead at most\n", shell[k].thickness, shell[k].scatter, worst);
		assert_true(worst < 0.1);
	}
	envmap_free(&env);
	envmap_free(&twice);
}

/* A lamp is found again where it stands, and as the brightest light. */
static void one_lamp(void **state)
{
	(void)state;
	struct envmap_box box = { { 0.48, -0.6, -0.64 }, { 0.1, 0.1 }, { 20, 10, 5 }, 0 };
	struct envmap env = envmap_room(256, (double[3]){ 0.01, 0.01, 0.01 }, (double[3]){ 0.01, 0.01, 0.01 }, 1, 1, &box);
	float rgb[3], dir[3] = { 0.48f, -0.6f, -0.64f }, away[3] = { -0.48f, -0.6f, -0.64f };
	envmap_at(rgb, &env, dir, 0);
	assert_float_equal(rgb[0], 20, 1e-3);
	assert_float_equal(rgb[2], 5, 1e-3);
	envmap_at(rgb, &env, away, 0);
	assert_float_equal(rgb[0], 0.01, 1e-4);
	struct envmap_light lights[2], *best = &lights[0];
	int n = envmap_lights(lights, 1, &env);
	assert_int_equal(n, 1);
	double cos_off = best->dir[0] * dir[0] + best->dir[1] * dir[1] + best->dir[2] * dir[2];
	assert_true(cos_off > cos(2 * M_PI / 180));
	// Solid angle of a square of half-width a: 4 asin(sin^2 a); its irradiance facing it, over pi.
	double expected = 20 * 4 * asin(sin(0.1) * sin(0.1)) / M_PI + 0.01 * 4;
	assert_float_equal(best->rgb[0], expected, 0.05 * expected);  // its edge is soft over half a degree of 5.7
	envmap_free(&env);
}

/* Hostile environment maps: negative light, none, no numbers, another shape. The shared ones are DWAB-compressed. */
static void strange_maps(void **state)
{
	(void)state;
	struct err err = { 0 };
	struct envmap env;
	struct image odd = image_new(30, 16, 3), bad = image_new(32, 16, 3), black = image_new(32, 16, 3);
	assert_false(envmap_take(&env, &odd, "odd", &err));
	assert_non_null(strstr(err.msg, "odd: 30 x 16"));
	assert_false(envmap_take(&env, &black, "black", &(struct err){ 0 }));
	for (int i = 0; i < 32 * 16 * 3; i++)
		bad.px[i] = i % 4 == 0 ? -5 : i % 4 == 1 ? NAN : i % 4 == 2 ? INFINITY : 1;
	assert_true(envmap_take(&env, &bad, "bad", &err));
	envmap_normalise(&env);
	assert_float_equal(envmap_level(&env), 1, 1e-5);
	envmap_free(&env);
	const char *path = bench_data("env/studio.exr");
	if (!path)
		skip();  // the shared data is not there
	struct image map;
	err = (struct err){ 0 };
	assert_true(imf_read_rgb(&map, path, 1 << 20, &err));
	assert_int_equal(map.width, 512);
	assert_true(envmap_take(&env, &map, path, &err));
	struct envmap_light lights[8];
	assert_int_equal(envmap_lights(lights, 8, &env), 8);
	for (int i = 0; i < 8; i++)
		assert_true(lights[i].rgb[1] > 0 && isfinite(lights[i].rgb[1]));
	envmap_free(&env);
	assert_false(imf_read_rgb(&map, path, 1000, &err));
	assert_false(imf_read_rgb(&map, "/dev/null", 1000, &err));
}

/* Batch of one ray straight down at (x, y) onto a flat iris. */
static void straight_down(struct iris_batch *b, const struct scene *s, double x, double y)
{
	*b = (struct iris_batch){ .n = 1 };
	b->fx[0] = (float)x;
	b->fy[0] = (float)y;
	b->fz[0] = 1;
	b->vz[0] = 1;
	scene_meet(b, s, &s->level[0]);
}

/* Parallel layers, light and sight along the axis: the integral of tissue.h, summed finely here, with the caustic's gain
 * at each depth from the solver. */
static void axial(double rgb[3], const struct scene *s)
{
	const struct tissue_optics *o = &s->optics;
	enum { N = 4000 };
	double all = o->abl_thickness + 0.5, w[3] = { 0, 0, -1 }, K[3] = { 0, 0, 0 };
	rgb[0] = rgb[1] = rgb[2] = 0;
	for (int i = 0; i < N; i++) {
		double depth = (i + 0.5) * all / N, abl = fmin(depth, o->abl_thickness), P[3] = { 0, 0, s->eye.iris_depth + depth };
		int l = depth < o->abl_thickness ? TISSUE_ABL : TISSUE_STROMA;
		double gain = lightpath_gain(&s->cornea, P, w, K);
		for (int k = 0; k < o->n; k++) {
			double tau = 2 * (o->extinction[TISSUE_ABL][k] * abl + o->extinction[TISSUE_STROMA][k] * (depth - abl));
			double light = M_PI * TISSUE_PHASE * o->source[l][k] * gain * exp(-tau) * all / N;
			for (int c = 0; c < 3; c++)
				rgb[c] += o->exposure * o->rgb[k][c] * light;
		}
	}
}

static double march_error(int steps, int quadrature)
{
	struct scene s;
	struct scene_conf conf = conf_of(steps);
	conf.quadrature = quadrature;
	scene_of(&s, &plain_eye, &conf, even, 0, 1.5);
	struct scene_lighting light = { .n = 1 };
	light.light[0] = (struct envmap_light){ { 0, 0, -1 }, { 1, 1, 1 } };
	const double id[3][3] = { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } };
	struct scene_beams beams = scene_beams(&s, &light, id);
	assert_int_equal(beams.n, 1);
	struct iris_batch b;
	straight_down(&b, &s, 0, 0);
	scene_scatter(&b, &s, &s.level[0], &beams);
	double expected[3], worst = 0;
	axial(expected, &s);
	for (int c = 0; c < 3; c++)
		worst = fmax(worst, fabs(b.rgb[c][0] / expected[c] - 1));
	scene_beams_free(&beams);
	scene_free(&s);
	return worst;
}

static void march_closed_form(void **state)
{
	(void)state;
	// 1e-3: the gain is interpolated between two planes 1.7 mm apart, and the map of thickness is single precision.
	double g24 = march_error(24, SCENE_GAUSS), g6 = march_error(6, SCENE_GAUSS), m48 = march_error(48, SCENE_MIDPOINT),
	       m6 = march_error(6, SCENE_MIDPOINT);
	print_message("march: gauss 24 %.2g, gauss 6 %.2g, midpoint 48 %.2g, midpoint 6 %.2g\n", g24, g6, m48, m6);
	assert_true(g24 < 1e-3);
	assert_true(g6 < 5e-3);
	assert_true(m48 < 3e-3);
	assert_true(m6 > 3 * g6);
}

/* What the table of a light says of its direction and irradiance, against the solver, over the whole iris. */
static void table_against_solver(void **state)
{
	(void)state;
	struct scene s;
	struct scene_conf conf = conf_of(6);
	scene_of(&s, &plain_eye, &conf, even, 0, 1.5);
	struct scene_lighting light = { .n = 1 };
	light.light[0] = (struct envmap_light){ { 0.6f, -0.48f, -0.64f }, { 1, 1, 1 } };
	const double id[3][3] = { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } };
	struct scene_beams beams = scene_beams(&s, &light, id);
	struct rng rng = { 5 };
	double worst = 0, worst_gain = 0, mean_gain = 0, n = 0;
	for (int i = 0; i < 500; i++) {
		double r = 5 * sqrt(rng_uniform(&rng)), t = 2 * M_PI * rng_uniform(&rng), w[3] = { 0.6, -0.48, -0.64 }, K[3];
		double P[3] = { r * cos(t), r * sin(t), 3.3 };
		float x = (float)P[0], y = (float)P[1], z = (float)P[2];
		struct march_light at;
		scene_light_at(&at, 0, 1, &x, &y, &z, &s, &beams.beam[0]);
		if (lightpath_solve_directional(K, &s.cornea, P, w) != LIGHTPATH_OK || hypot(K[0], K[1]) > 5.6)
			continue;
		double d[3] = { K[0] - P[0], K[1] - P[1], K[2] - P[2] }, len = sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
		worst = fmax(worst, hypot(hypot(at.x[0][0] - d[0] / len, at.y[0][0] - d[1] / len), at.z[0][0] - d[2] / len));
		double off = fabs(-at.power[0][0] * at.z[0][0] / lightpath_gain(&s.cornea, P, w, K) - 1);
		worst_gain = fmax(worst_gain, off);
		mean_gain += off;
		n++;
	}
	print_message("table: direction %.2g rad, irradiance %.2g, at worst %.2g\n", worst, mean_gain / n, worst_gain);
	assert_true(worst > 0 && worst < 0.004);  // a quarter of a degree
	assert_true(mean_gain / n < 2e-3);
	assert_true(worst_gain < 0.04);  // beside the rim, where the gain falls off within two of the grid's steps
	scene_beams_free(&beams);
	scene_free(&s);
}

/* Light on a flat iris against the solver: three lights of a colour each, the lowest one 8 degrees above the plane of the iris. */
static void flat_against_solver(void **state)
{
	(void)state;
	struct scene s;
	struct scene_conf conf = conf_of(6);
	conf.shading = SCENE_TEXELS;
	conf.path = SCENE_PATH_GRID;
	scene_of(&s, &plain_eye, &conf, even, 0, 1.5);
	struct scene_lighting light = { .n = 3 };
	light.light[0] = (struct envmap_light){ { 0, 0, -1 }, { 1, 0, 0 } };
	light.light[1] = (struct envmap_light){ { 0.6f, -0.48f, -0.64f }, { 0, 1, 0 } };
	light.light[2] = (struct envmap_light){ { -0.792f, 0.594f, -0.14f }, { 0, 0, 1 } };
	const double id[3][3] = { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } };
	float *flat = scene_paths_flat(&s, &light, id);
	double mean[3] = { 0 }, worst[3] = { 0 }, most[3] = { 0 }, n = 0, width = s.conf.limbus_width / s.limbus[0];
	for (int i = 0; i < SCENE_FLAT * SCENE_FLAT; i++) {
		double step = 2 * s.extent / SCENE_FLAT, P[3] = { (i % SCENE_FLAT + 0.5) * step - s.extent, (i / SCENE_FLAT + 0.5) * step - s.extent, s.eye.iris_depth };
		if (hypot(P[0], P[1]) > s.limbus[0])
			continue;
		n++;
		for (int l = 0; l < 3; l++) {
			double w[3] = { light.light[l].dir[0], light.light[l].dir[1], light.light[l].dir[2] }, K[3], expected = 0;
			enum lightpath_status status = lightpath_solve_directional(K, &s.cornea, P, w);
			if (status == LIGHTPATH_OK || status == LIGHTPATH_BEYOND_RIM) {
				double t = (hypot(K[0] / s.limbus[0], K[1] / s.limbus[1]) - 1 + width / 2) / width;
				t = fmin(fmax(t, 0), 1);
				expected = lightpath_gain(&s.cornea, P, w, K) * (1 - t * t * (3 - 2 * t));
			}
			double off = fabs((double)flat[4 * i + l] - s.flat[l] * expected);
			mean[l] += off;
			worst[l] = fmax(worst[l], off);
			most[l] = fmax(most[l], s.flat[l] * expected);
		}
	}
	for (int l = 0; l < 3; l++) {
		print_message("flat light %d: off by %.2g on the mean, %.2g at worst, of the brightest\n", l, mean[l] / n / most[l], worst[l] / most[l]);
		assert_true(most[l] > 0);
		assert_true(mean[l] / n < 2e-3 * most[l]);
		// Where the limbus stops the light within three of the field's rings; and where the focus of a low light ends, next to the rim.
		assert_true(worst[l] < (l < 2 ? 0.03 : 0.25) * most[l]);
	}
	free(flat);
	scene_free(&s);
}

/* Gauss's rule for fading light: 4 steps are what 24 of Gauss-Legendre's are. */
static void exponential_rule(void **state)
{
	(void)state;
	double e4 = march_error(4, SCENE_EXPONENTIAL), e3 = march_error(3, SCENE_EXPONENTIAL), g4 = march_error(4, SCENE_GAUSS);
	print_message("march: exponential 4 %.2g, 3 %.2g, Gauss-Legendre 4 %.2g\n", e4, e3, g4);
	assert_true(e4 < 2e-3);
	assert_true(e3 < 1.2e-2);
	assert_true(g4 > 5 * e4);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(even_light),
		cmocka_unit_test(white_by_photons),
		cmocka_unit_test(one_lamp),
		cmocka_unit_test(strange_maps),
		cmocka_unit_test(march_closed_form),
		cmocka_unit_test(table_against_solver),
		cmocka_unit_test(flat_against_solver),
		cmocka_unit_test(exponential_rule),
	};
	return cmocka_run_group_tests(tests, 0, 0);
}
