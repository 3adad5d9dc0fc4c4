/* What is read off the reference photograph, and how the beauty views are exposed: closed forms. */
#include "tests/lib/unit.h"

#include "draw/photo/reference.h"
#include "draw/studio.h"

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
	struct shot shot = { .env = env };
	for (int i = 0; i < 3; i++)
		shot.fit.cam_from_eye[i][i] = 1;
	struct eye eye = { .limbus_radius = 5.85 };
	double rgb[3] = { 0.5, 0.4, 0.3 }, bright[3] = { 2, 1, 0.5 };
	shot_unlight(rgb, &shot, &eye, 11.5);  // through a camera that projects nothing: every direction counts alike
	NEAR(rgb[0], 0.5, 0.01);
	NEAR(rgb[1], 0.4, 0.01);
	NEAR(rgb[2], 0.3, 0.01);
	shot_unlight(bright, &shot, &eye, 11.5);  // none returns more than 0.95, and its hue stays
	NEAR(bright[0], 0.95, 1e-12);
	NEAR(bright[1], 0.475, 1e-12);
	NEAR(bright[2], 0.2375, 1e-12);
	envmap_free(&env);
}

static void grey_shows_where_the_eye_does_not(void **state)
{
	(void)state;
	struct image rgba = image_new(101, 101, 4);
	for (int i = 0; i < 101 * 101; i++)
		rgba.px[4 * i + 3] = i < 101;  // the first row is covered, in black
	image_at(&rgba, 50, 0)[1] = 0.25f;
	struct image out = studio_on_grey(&rgba, 2);
	NEAR(image_at(&out, 50, 50)[0], 0.115, 1e-6);
	NEAR(image_at(&out, 0, 100)[0], 0.115 + (0.030 - 0.115) * pow(100 / 101.0, 2), 1e-6);
	NEAR(image_at(&out, 50, 0)[1], 0.5, 1e-6);
	NEAR(image_at(&out, 50, 0)[0], 0, 1e-6);
	image_free(&out);
	image_free(&rgba);
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
		cmocka_unit_test(grey_shows_where_the_eye_does_not),
		cmocka_unit_test(a_window_is_as_large_as_the_photograph_lets_it),
		cmocka_unit_test(the_edges_blur_is_the_limbus_width),
	};
	return cmocka_run_group_tests(tests, 0, 0);
}
