/* render: views against the light path solved the other way round, and one way to draw them against another. */
#include <omp.h>

#include "draw/eye/quick/hits.h"
#include "draw/eye/render.h"
#include "draw/eye/surface.h"
#include "math/rng.h"
#include "tests/lib/scenes/plain_scene.h"
#include "tests/lib/unit.h"

static struct fit fit_at(double theta, int width, int height, double focal)
{
	struct fit fit = { .ok = true, .width = width, .height = height, .coverage = 1, .limbus_aspect = 1 };
	double c = cos(theta), s = sin(theta);
	double pose[4][4] = { { c, 0, s, 0.2 }, { 0, 1, 0, -0.1 }, { -s, 0, c, 150 }, { 0, 0, 0, 1 } };
	memcpy(fit.cam_from_eye, pose, sizeof pose);
	fit.camera = (struct camera){ .focal_px = focal, .center_px = { width / 2.0, height / 2.0 }, .source = CAMERA_CONF };
	return fit;
}

static const double spot_at[2] = { 2.6, -1.9 };

static void spot(float rgb[3], double x, double y)
{
	even(rgb, x, y);
	double d = hypot(x - spot_at[0], y - spot_at[1]);
	for (int c = 0; c < 3; c++)
		rgb[c] *= (float)(1 + 4 * exp(-d * d / (2 * 0.15 * 0.15)));
}

/* Photo pixel in which an iris point (eye frame) is seen through the cornea: exact light path. */
static bool project_refracted(double px[2], const struct fit *fit, const struct cornea *cornea, const double P[3])
{
	double C[3], K[3];
	fit_camera_in_eye(C, fit);
	return lightpath_solve(K, cornea, P, C) == LIGHTPATH_OK && fit_project(px, fit, K);
}

/* Renders a bright spot of the iris; its centroid is where the light path from the spot to the camera, solved the other
 * way round, says it is seen. */
static void seen_through_the_cornea(double index, double theta)
{
	struct eye eye = plain_eye;
	eye.index = index;
	struct scene s;
	struct scene_conf conf = conf_of(6);
	scene_of(&s, &eye, &conf, spot, 0, 0.5);
	struct fit fit = fit_at(theta, 640, 640, 5000);
	struct scene_view view = scene_view_photo(&fit, (double[4]){ 0, 0, 640, 640 }, 1);
	struct envmap env = envmap_room(32, grey, grey, 1, 0, 0);
	struct scene_lighting light = scene_lighting(&env, 0, 4);
	scene_fit_colour(&s, &view, &light);
	struct image image = scene_render(&s, &view, &light, 0);
	double P[3] = { spot_at[0], spot_at[1], eye.iris_depth }, px[2], sum = 0, x = 0, y = 0;
	assert_true(index > 1 ? project_refracted(px, &fit, &s.cornea, P) : fit_project(px, &fit, P));
	for (int v = (int)px[1] - 12; v <= (int)px[1] + 12; v++)
		for (int u = (int)px[0] - 12; u <= (int)px[0] + 12; u++) {
			double w = fmax(image_at(&image, u, v)[1] - 0.4, 0);
			sum += w;
			x += w * (u + 0.5);
			y += w * (v + 0.5);
		}
	assert_true(sum > 1);
	// 0.15 px of 30 px a millimetre: the spot is drawn in texels of 0.05 mm and seen askew.
	assert_float_equal(x / sum, px[0], 0.15);
	assert_float_equal(y / sum, px[1], 0.15);
	image_free(&image);
	envmap_free(&env);
	scene_free(&s);
}

static void places(void **state)
{
	(void)state;
	seen_through_the_cornea(1, 0.3);  // flat limit: no refraction
	seen_through_the_cornea(1.336, 0);
	seen_through_the_cornea(1.336, 0.5);
}

/* A turned eye stays in its place, and what the picture spans where the eye shows is the field that was asked for. */
static void framing(void **state)
{
	(void)state;
	struct scene s;
	struct scene_conf conf = conf_of(6);
	scene_of(&s, &plain_eye, &conf, even, 0, 0.5);
	for (int k = 0; k < 3; k++) {
		const double field = 27;
		struct scene_view v = scene_view_turned(&s, 0.4 * k, -0.3 * k, field, 200);
		double centre[3];
		for (int i = 0; i < 3; i++)
			centre[i] = v.cam_from_eye[i][2] * s.sclera_z + v.cam_from_eye[i][3];
		const double shows = centre[2] - 0.1 * conf.sclera_radius;
		assert_float_equal(shows, 500, 1e-4);
		assert_float_equal(v.camera.focal_px * (centre[0] + field / 2) / shows + v.camera.center_px[0], 200, 1e-4);
		assert_float_equal(v.camera.focal_px * (centre[1] - field / 2) / shows + v.camera.center_px[1], 0, 1e-4);
	}
	scene_free(&s);
}

/* In its own view the rendering shows the texture, whatever light, relief and pigments say, less what the cornea keeps. */
static void photograph_comes_back(void **state)
{
	(void)state;
	struct scene s;
	struct scene_conf conf = conf_of(6);
	scene_of(&s, &plain_eye, &conf, even, bumps, 1.5);
	struct fit fit = fit_at(0.35, 480, 480, 4200);
	struct scene_view view = scene_view_photo(&fit, (double[4]){ 0, 0, 480, 480 }, 1);
	struct envmap_box box = { { -0.48, -0.6, -0.64 }, { 0.2, 0.2 }, { 12, 12, 12 }, 0 };
	struct envmap env = envmap_room(64, (double[3]){ 0.5, 0.5, 0.5 }, (double[3]){ 0.2, 0.2, 0.2 }, 1, 1, &box);
	struct scene_lighting light = scene_lighting(&env, 0, 4);
	scene_fit_colour(&s, &view, &light);
	struct image image = scene_render(&s, &view, &light, 0);
	struct rng rng = { 8 };
	double mean = 0;
	for (int i = 0; i < 200; i++) {
		double r = rng_range(&rng, 2.2, 4.5), t = 2 * M_PI * rng_uniform(&rng), P[3] = { r * cos(t), r * sin(t), 3.3 }, px[2];
		assert_true(project_refracted(px, &fit, &s.cornea, P));
		mean += fabs(image_sample(&image, px[0], px[1], 0) / 0.30 - 1) / 200;
	}
	assert_true(mean < 0.03);  // relief steep against a texel makes single pixels differ, their mean hardly
	image_free(&image);
	envmap_free(&env);
	scene_free(&s);
}

/* The black of the pupil mirrors an even room by ((n - 1) / (n + 1))^2. */
static void mirror_at_normal(void **state)
{
	(void)state;
	struct scene s;
	struct scene_conf conf = conf_of(4);
	scene_of(&s, &plain_eye, &conf, even, 0, 2);
	struct scene_view view = scene_view_turned(&s, 0, 0, 27, 128);
	struct envmap env = envmap_room(32, grey, grey, 1, 0, 0);
	struct scene_lighting light = scene_lighting(&env, &env, 4);
	struct image image = scene_render(&s, &view, &light, 0);
	double f = (0.336 / 2.336) * (0.336 / 2.336);
	assert_float_equal(image_at(&image, 64, 64)[1], f, 1e-3 * f + 1e-5);
	assert_float_equal(image_at(&image, 64, 64)[3], 1, 0);
	assert_float_equal(image_at(&image, 1, 1)[3], 0, 0);
	image_free(&image);
	envmap_free(&env);
	scene_free(&s);
}

/* The same bytes for any number of threads, and numbers everywhere, from any side. */
static void threads_and_numbers(void **state)
{
	(void)state;
	struct scene s;
	struct scene_conf conf = conf_of(4);
	scene_of(&s, &plain_eye, &conf, spot, bumps, 1.5);
	struct envmap env = envmap_room(64, grey, (double[3]){ 0.1, 0.1, 0.1 }, 0.1, 0, 0);
	struct scene_lighting light = scene_lighting(&env, &env, 8);
	struct scene_view first = scene_view_turned(&s, 0.2, 0.1, 27, 64);
	scene_fit_colour(&s, &first, &light);
	struct rng rng = { 13 };
	for (int i = 0; i < 6; i++) {
		struct scene_view view = scene_view_turned(&s, rng_range(&rng, -3, 3), rng_range(&rng, -1.5, 1.5), 27, 97);
		view.samples = 2;
		omp_set_num_threads(1);
		struct image one = scene_render(&s, &view, &light, 0);
		omp_set_num_threads(4);
		struct image four = scene_render(&s, &view, &light, 0);
		assert_memory_equal(one.px, four.px, sizeof(float) * 4 * 97 * 97);
		for (int k = 0; k < 4 * 97 * 97; k++)
			assert_true(isfinite(one.px[k]) && one.px[k] >= 0);
		image_free(&one);
		image_free(&four);
	}
	envmap_free(&env);
	scene_free(&s);
}

/* Mean difference of a picture marched from every `apart`-th texel from one marched along every ray. */
static double texels_off(int apart, double relief(double x, double y))
{
	struct envmap_box box = { { -0.48, -0.6, -0.64 }, { 0.2, 0.2 }, { 12, 12, 12 }, 0 };
	struct envmap env = envmap_room(64, (double[3]){ 0.5, 0.5, 0.5 }, (double[3]){ 0.2, 0.2, 0.2 }, 1, 1, &box);
	struct scene_lighting light = scene_lighting(&env, &env, 4);
	struct image image[2];
	for (int k = 0; k < 2; k++) {
		struct scene s;
		struct scene_conf conf = conf_of(k ? 4 : 16);
		conf.shading = k ? SCENE_TEXELS : SCENE_RAYS;
		conf.quadrature = k ? SCENE_EXPONENTIAL : SCENE_GAUSS;
		conf.shadow = 16;
		conf.map_size = 512;
		conf.apart = apart;
		struct err err = { 0 };
		assert_true(painted_scene(&s, 512, &plain_eye, &conf, even, relief, 1.5, &err));
		struct scene_view view = scene_view_turned(&s, 0, 0, 16, 480);
		scene_fit_colour(&s, &view, &light);
		view = scene_view_turned(&s, 0.3, -0.2, 16, 480);
		image[k] = scene_render(&s, &view, &light, 0);
		scene_free(&s);
	}
	double off = 0, all = 0, cover = 0;
	for (int i = 0; i < 480 * 480; i++) {
		for (int c = 0; c < 3; c++) {
			off += fabs(image[0].px[4 * i + c] - image[1].px[4 * i + c]);
			all += image[0].px[4 * i + c];
		}
		cover = fmax(cover, fabs(image[0].px[4 * i + 3] - image[1].px[4 * i + 3]));
	}
	assert_true(cover < 0.01);
	for (int k = 0; k < 2; k++)
		image_free(&image[k]);
	envmap_free(&env);
	return off / all;
}

/* The march from the map's texels shows what the march along every ray does: light under a relief of half a millimetre's
 * waves is smooth against texels of 0.05 mm, twice the pixels. */
static void texels_against_rays(void **state)
{
	(void)state;
	double off = texels_off(2, bumps);
	print_message("texels against rays: %.2g\n", off);
	assert_true(off > 0 && off < 0.008);  // the pupil's edge differs by part of a texel; its ring is 2 % of the eye
}

static double steep(double x, double y)
{
	return 0.1 * sin(12 * x) * cos(4 * y);
}

/* Marched from every texel, too, steep relief throws its shadows. */
static void every_texel_has_shadows(void **state)
{
	(void)state;
	double off = texels_off(1, steep);
	print_message("every texel, steep relief: %.2g\n", off);
	assert_true(off < 0.005);  // without them: 0.008
}

/* What rays met is kept while only light moves: the same bytes as without, and no ray traced. What is hidden is left out, and
 * the rest is as it was; an eye all hidden traces nothing. */
static void kept_and_hidden(void **state)
{
	(void)state;
	enum { N = 150 };
	struct scene s;
	struct scene_conf conf = conf_of(4);
	conf.shading = SCENE_TEXELS;
	scene_of(&s, &plain_eye, &conf, spot, bumps, 1.5);
	struct envmap_box box[2] = { { { -0.48, -0.6, -0.64 }, { 0.2, 0.2 }, { 12, 12, 12 }, 0 }, { { 0.6, -0.48, -0.64 }, { 0.2, 0.2 }, { 5, 12, 12 }, 0 } };
	struct scene_hits *hits = scene_hits_new();
	struct scene_view view = scene_view_turned(&s, 0.2, 0.1, 27, N);
	for (int k = 0; k < 2; k++) {
		struct envmap env = envmap_room(64, grey, grey, 0.3, 1, &box[k]);
		struct scene_lighting light = scene_lighting(&env, &env, 8);
		struct scene_count count = { 0 }, plain = { 0 };
		view.hits = hits;
		struct image a = scene_render(&s, &view, &light, &count);
		view.hits = 0;
		struct image b = scene_render(&s, &view, &light, &plain);
		assert_memory_equal(a.px, b.px, N * N * 4 * sizeof(float));
		assert_int_equal(count.kept, k ? N * N : 0);
		assert_int_equal(count.rays, k ? 0 : N * N);
		assert_int_equal(plain.rays, N * N);
		unsigned char visible[N * N];
		for (int i = 0; i < N * N; i++)
			visible[i] = i / N > N / 2;
		view.visible = visible;
		struct scene_count half = { 0 }, none = { 0 };
		struct image c = scene_render(&s, &view, &light, &half);
		assert_true(half.hidden > N * N / 3 && half.rays + half.hidden == N * N);
		for (int i = 0; i < N * N; i++)
			assert_true(!visible[i] || !memcmp(b.px + 4 * i, c.px + 4 * i, 4 * sizeof(float)));
		memset(visible, 0, sizeof visible);
		struct image d = scene_render(&s, &view, &light, &none);
		assert_true(none.rays == 0 && none.hidden == N * N && image_at(&d, N / 2, N / 2)[3] == 0);
		view.visible = 0;
		image_free(&a);
		image_free(&b);
		image_free(&c);
		image_free(&d);
		envmap_free(&env);
	}
	scene_hits_free(hits);
	scene_free(&s);
}

/* Depth and normal of the outside: the apex from the front, and the sphere beside the limbus. */
static void surface(void **state)
{
	(void)state;
	struct scene s;
	struct scene_conf conf = conf_of(4);
	scene_of(&s, &plain_eye, &conf, even, 0, 1.5);
	struct scene_view view = scene_view_turned(&s, 0, 0, 27, 271);
	struct image image = scene_surface(&s, &view);
	const float *apex = image_at(&image, 135, 135), *side = image_at(&image, 135 + 85, 135), *off = image_at(&image, 2, 2);
	assert_float_equal(apex[0], view.cam_from_eye[2][3], 1e-4);
	assert_float_equal(apex[3], -1, 1e-6);
	double x = (85.0 / 271) * 27 / 500, o = view.cam_from_eye[2][3] + s.sclera_z, R = s.conf.sclera_radius;  // ray (x, 0, 1) t
	double t = (o - sqrt(o * o - (1 + x * x) * (o * o - R * R))) / (1 + x * x);
	assert_float_equal(side[0], t, 1e-3);
	assert_float_equal(side[1], x * t / R, 1e-5);
	assert_float_equal(side[3], (t - o) / R, 1e-5);
	assert_true(isinf(off[0]) && off[3] == 0);
	image_free(&image);
	scene_free(&s);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(places),
		cmocka_unit_test(framing),
		cmocka_unit_test(photograph_comes_back),
		cmocka_unit_test(mirror_at_normal),
		cmocka_unit_test(threads_and_numbers),
		cmocka_unit_test(texels_against_rays),
		cmocka_unit_test(every_texel_has_shadows),
		cmocka_unit_test(kept_and_hidden),
		cmocka_unit_test(surface),
	};
	return cmocka_run_group_tests(tests, 0, 0);
}
