/* What is read off the reference photograph, and how the beauty views are exposed: closed forms. */
#include "tests/lib/scratch.h"
#include "tests/lib/unit.h"

#include "base/mem.h"
#include "draw/bloom.h"
#include "draw/eye/tint.h"
#include "draw/photo/reference.h"
#include "draw/studio.h"
#include "draw/tone.h"

/* The same radiance from everywhere: a plane facing anywhere receives it. */
static struct envmap even(float radiance)
{
	struct envmap env;
	struct err err = { 0 };
	struct image map = image_new(64, 32, 3);
	for (int i = 0; i < 64 * 32 * 3; i++)
		map.px[i] = radiance;
	assert_true(envmap_take(&env, &map, "even", &err));
	return env;
}

static void even_light_exposes_the_sclera_to_62_per_cent(void **state)
{
	(void)state;
	struct envmap env = even(1);
	double grey[3] = { 0.5, 0.5, 0.5 }, black[3] = { 1e-4, 1e-4, 1e-4 };
	NEAR(studio_exposure(&env, grey), 0.62 / 0.5, 0.02);  // the map's cells: irradiance to a per cent
	assert_true(studio_exposure(&env, black) == 3);
	envmap_free(&env);
}

/* pigment.json's white: as measured, by the level of the light on the eye and what of its error is believed; the sclera no brighter than 0.95, in its hue. */
static void the_photographs_white_is_read(void **state)
{
	(void)state;
	struct scene_white w;
	struct err err = { 0 };
	assert_true(scene_white(&w, 0, &err) && scene_white(&w, scratch_path("none.json"), &err));
	assert_true(w.rgb[0] == 1 && w.rgb[2] == 1 && !w.has_sclera);
	scratch_text("old.json", "{\"white\": {\"rgb\": [0.6, 0.5, 0.4]}}");
	assert_true(scene_white(&w, scratch_path("old.json"), &err) && !w.has_sclera);
	NEAR(w.rgb[2], 0.4, 1e-12);
	scratch_text("white.json", "{\"without\": \"grey\", \"white\": {\"rgb\": [0.6, 0.5, 0.4], \"level\": 0.5, \"error\": [1.2, 1, 0.9], \"sclera\": [1.9, 0.95, 0.5]}}");
	assert_true(scene_white(&w, scratch_path("white.json"), &err) && w.has_sclera);
	NEAR(w.rgb[0], 0.36, 1e-12);
	NEAR(w.rgb[1], 0.25, 1e-12);
	NEAR(w.rgb[2], 0.18, 1e-12);
	NEAR(w.sclera[0], 0.95, 1e-12);
	NEAR(w.sclera[1], 0.475, 1e-12);
	NEAR(w.sclera[2], 0.25, 1e-12);
	static const char *const bad[] = { "\"rgb\": [0, 1, 1]", "\"rgb\": [1, 1, 30]", "\"rgb\": [1, 1, 1], \"level\": -1", "\"rgb\": [1, 1, 1], \"error\": [1, 1]",
		                           "\"rgb\": [1, 1, 1], \"sclera\": [0.5, 0.5, 1e9]", "\"level\": 1" };
	for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
		char text[200];
		snprintf(text, sizeof text, "{\"white\": {%s}}", bad[i]);
		scratch_text("bad.json", text);
		err = (struct err){ 0 };
		assert_false(scene_white(&w, scratch_path("bad.json"), &err));
		assert_non_null(strstr(err.msg, "bad.json"));
	}
}

static void grey_shows_where_the_eye_does_not(void **state)
{
	(void)state;
	struct image rgba = image_new(101, 101, 4);
	for (int i = 0; i < 101 * 101; i++)
		rgba.px[4 * i + 3] = i < 101;  // the first row is covered, in black
	image_at(&rgba, 50, 0)[1] = 0.25f;
	struct image out = studio_on_grey(&rgba, 2, &(struct studio_finish){ 0 });
	NEAR(image_at(&out, 50, 50)[0], 0.115, 1e-6);
	NEAR(image_at(&out, 0, 100)[0], 0.115 + (0.030 - 0.115) * pow(100 / 101.0, 2), 1e-6);
	NEAR(image_at(&out, 50, 0)[1], 0.5, 1e-6);
	NEAR(image_at(&out, 50, 0)[0], 0, 1e-6);
	image_free(&out);
	image_free(&rgba);
}

/* Narkowicz's own figures: f 0.2 -> 0.2995, 1 -> 0.8038, 4 -> 0.9734 by his polynomials; light without end comes to white, and never beyond. */
static void highlights_bend_as_on_film(void **state)
{
	(void)state;
	static const double of[] = { 0, 0.25, 1.25, 5, 1000, -0.1 }, to[] = { 0, 0.1064 / 0.3552, 2.54 / 3.16, 40.28 / 41.38, 1, 0 };
	for (int share = 0; share <= 2; share++)
		for (int i = 0; i < COUNT(of); i++) {
			struct image rgb = image_new(1, 1, 3);
			for (int c = 0; c < 3; c++)
				rgb.px[c] = (float)of[i];
			tone(&rgb, 0.5 * share);
			for (int c = 0; c < 3; c++)
				NEAR(rgb.px[c], share ? (share * to[i] + (2 - share) * fmin(fmax(of[i], 0), 1)) / 2 : of[i], 1e-4);
			image_free(&rgb);
		}
	// A light's edge keeps its steps: of what was cut off at white all would be alike.
	struct image out = studio_on_grey(&(struct image){ 2, 1, 4, (float[]){ 1.5f, 0, 0, 1, 3, 0, 0, 1 } }, 1, &(struct studio_finish){ .tone = 1 });
	assert_true(out.px[3] - out.px[0] > 0.05 && out.px[3] < 1);
	image_free(&out);
}

/* Light that a spot throws so far away in a picture of n px, over the spot's own. */
static double thrown(int n, double share, double away)
{
	struct image rgb = image_new(n, n, 3);
	const int spot = n / 64;
	for (int y = 0; y < spot; y++)
		for (int x = 0; x < spot; x++)
			image_at(&rgb, n / 2 - spot / 2 + x, n / 2 - spot / 2 + y)[1] = 100;
	double before = 0, after = 0, red = 0;
	for (long i = 0; i < 3L * n * n; i++)
		before += rgb.px[i];
	bloom(&rgb, share);
	for (long i = 0; i < (long)n * n; i++) {
		after += rgb.px[3 * i + 1];
		red = fmax(red, rgb.px[3 * i]);
	}
	NEAR(after, before, 0.03 * share * before);  // little reaches the borders
	assert_true(red == 0);
	const double seen = image_at(&rgb, (int)(n * (0.5 + away)), n / 2)[1] / 100.0;
	image_free(&rgb);
	return seen;
}

static void bright_light_glows_and_none_is_lost(void **state)
{
	(void)state;
	const double near = thrown(512, 0.1, 0.03), far = thrown(512, 0.1, 0.06), farther = thrown(512, 0.1, 0.12);
	assert_true(near > far && far > farther && farther > 0);
	// As the square of the distance, give or take what octaves are.
	NEAR(log2(near / farther), 4, 0.8);
	NEAR(thrown(512, 0.2, 0.06), 2 * far, 1e-3 * far);
	NEAR(thrown(1024, 0.1, 0.06), far, 0.1 * far);  // the same in a picture of another size
	struct image rgb = image_new(37, 19, 3), small = image_new(9, 5, 3);
	for (long i = 0; i < 3L * 37 * 19; i++)
		rgb.px[i] = 0.25F;
	bloom(&rgb, 0.5);  // what is even stays even, also at the borders
	for (long i = 0; i < 3L * 37 * 19; i++)
		NEAR(rgb.px[i], 0.25, 1e-6);
	image_at(&small, 4, 2)[0] = 1;
	bloom(&small, 1);
	assert_true(image_at(&small, 4, 2)[0] == 1);
	image_free(&rgb);
	image_free(&small);
}

/* As much light as an even box, gathered in its middle. */
static void a_softbox_is_brightest_in_its_middle(void **state)
{
	(void)state;
	const double dark[3] = { 0, 0, 0 };
	float even[3], hot[3], toward[3] = { 0.6F, 0, -0.8F };
	struct envmap_box box = { { 0.6, 0, -0.8 }, { 0.2, 0.3 }, { 10, 20, 5 }, 0 };
	struct envmap flat = envmap_room(256, dark, dark, 1, 1, &box);
	box.hot = 1;
	struct envmap round = envmap_room(256, dark, dark, 1, 1, &box);
	envmap_irradiance(even, &flat, toward);
	envmap_irradiance(hot, &round, toward);
	NEAR(hot[1], even[1], 0.03 * even[1]);
	envmap_at(even, &flat, toward, 0);
	envmap_at(hot, &round, toward, 0);
	NEAR(even[1], 20, 0.01);
	assert_true(hot[1] > 2 * even[1]);
	const float edge[3] = { (float)sin(0.6435 + 0.19), 0, (float)-cos(0.6435 + 0.19) };
	envmap_at(hot, &round, edge, 0);
	assert_true(hot[1] < 0.7F * even[1] && hot[1] > 0.3F * even[1]);
	envmap_free(&flat);
	envmap_free(&round);
}

static void a_window_is_as_large_as_the_photograph_lets_it(void **state)
{
	(void)state;
	struct shot shot = { .fit = { .limbus = { 400, 300, 99, 90, 0 }, .width = 2000, .height = 450, .coverage = 0.5, .theta = M_PI / 4 } };
	shot_window(&shot, 109);
	const double want[4] = { 182, 82, 618, 450 };
	for (int i = 0; i < 4; i++)
		assert_true(shot.window[i] == want[i]);
	NEAR(shot.scale, 4, 1e-12);
	shot_window(&shot, 5000);
	NEAR(shot.scale, 1, 0);
	NEAR(shot_merit(&shot.fit), 99 * 0.5 * 0.5, 1e-12);
}

static void the_edges_blur_is_the_limbus_width(void **state)
{
	(void)state;
	struct shot shot = { .fit = { .camera = { .focal_px = 5000 }, .edge_sigma_px = 5 } };
	shot.fit.cam_from_eye[2][3] = 100;
	NEAR(shot_limbus_width(&shot), 100.0 / 5000 * 5 / 0.2236, 1e-12);
	shot.fit.edge_sigma_px = 1000;
	NEAR(shot_limbus_width(&shot), 1.2, 0);
	shot.fit.edge_sigma_px = NAN;
	NEAR(shot_limbus_width(&shot), 0.4, 0);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(even_light_exposes_the_sclera_to_62_per_cent),
		SCRATCH_TEST(the_photographs_white_is_read),
		cmocka_unit_test(grey_shows_where_the_eye_does_not), cmocka_unit_test(bright_light_glows_and_none_is_lost), cmocka_unit_test(highlights_bend_as_on_film),
		cmocka_unit_test(a_softbox_is_brightest_in_its_middle),
		cmocka_unit_test(a_window_is_as_large_as_the_photograph_lets_it),
		cmocka_unit_test(the_edges_blur_is_the_limbus_width),
	};
	return cmocka_run_group_tests(tests, 0, 0);
}
