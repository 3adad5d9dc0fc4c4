/* Wrinkle lines against a skin of known relief (tests/lib/scenes/wrinkle_scene.h). */
#include "base/file.h"
#include "base/json.h"
#include "math/stats.h"
#include "tests/lib/scenes/wrinkle_scene.h"
#include "tests/lib/scratch.h"
#include "tests/lib/unit.h"

/* The defaults of config/track.conf. */
static const struct wrinkle_conf conf = { .width_mm = { 0.12, 0.8 }, .scales = 6, .drop = 0.04, .significance = 6, .pattern = 2.5, .length_mm = 4, .slope = 1.5, .frames = 8 };

static double off_groove(const struct groove *g, const double mm[3])
{
	double u = mm[0] - g->center[0], v = mm[1] - g->center[1], angle = atan2(v, u);
	angle += angle < g->from - M_PI ? 2 * M_PI : 0;
	return hypot(hypot(u, v) - g->radius, g->radius * fmax(0, fmax(g->from - angle, angle - g->to)));
}

struct score {
	double off, covered, depth, width, half;  // mm; share; found over true, medians; depth half way over that at the peak
};

/* What was found of a groove. */
static struct score score_of(const struct wrinkle_pose *p, const struct groove *g)
{
	enum { MOST = 2000 };
	double off[MOST], depth[MOST], width[MOST], half[MOST];
	struct score s = { 0 };
	int n = 0, seen = 0;
	for (int i = 0; i < p->n; i++)
		for (int k = 0; k < p->line[i].n && n < MOST; k++) {
			const struct wrinkle_point *q = &p->line[i].point[k];
			double from_end = fmin(k, p->line[i].n - 1 - k), d = off_groove(g, q->mm);
			if (d > 1.5)
				continue;
			off[n] = d;
			depth[n] = q->depth / g->depth;
			width[n] = q->width / g->width;
			half[n] = from_end > 1 ? (double)p->line[i].depth[p->line[i].n + k] / q->depth : 0.5;
			n++;
		}
	for (int j = 0; j <= 100; j++) {
		double a = g->from + (g->to - g->from) * j / 100, best = INFINITY;
		for (int i = 0; i < p->n; i++)
			for (int k = 0; k < p->line[i].n; k++)
				best = fmin(best, hypot(p->line[i].point[k].mm[0] - g->center[0] - g->radius * cos(a), p->line[i].point[k].mm[1] - g->center[1] - g->radius * sin(a)));
		seen += best < 0.8;
	}
	s.covered = seen / 101.0;
	s.off = stats_median(n, off);
	s.depth = stats_median(n, depth);
	s.width = stats_median(n, width);
	s.half = stats_median(n, half);
	return s;
}

static void grooves_found(const struct scene_light *light)
{
	struct scene s;
	scene_open(&s, 1, light);
	struct wrinkles w = { 0 };
	struct err err = { 0 };
	assert_true(wrinkle_find(&w, "frown", SCENE_FRAMES, s.frame, &s.ground, &conf, &err));
	const struct wrinkle_pose *p = &w.pose[0];
	for (int i = 0; i < GROOVES; i++) {
		struct score r = score_of(p, &scene_grooves[i]);
		print_message("groove %d: %.2f mm off, %.0f %% covered, depth x %.2f, width x %.2f, half way %.2f\n", i, r.off, 100 * r.covered, r.depth, r.width, r.half);
		// half a px is 0.06 mm; a line may end early where its groove fades over one w
		NEAR(r.off, 0, 0.10);
		assert_true(r.covered > 0.85);
		// the light is known to about 0.15 (below), and depth goes with it; a line's width is that of a dozen px
		NEAR(r.depth, 1, 0.2);
		NEAR(r.width, 1, 0.2);
		NEAR(r.half, 0.5, 0.15);
	}
	// a skin that all but faces the camera looks alike under a lamp before it and under light from all round; its lines do not
	double share = w.ambient / (w.ambient + w.from[2]), is = light->sky / (light->sky + light->lamp[2]);
	print_message("share of the light that comes from everywhere: %.2f, is %.2f\n", share, is);
	NEAR(share, is, 0.2);
	for (int i = 0; i < p->n; i++)
		for (int k = 0; k < p->line[i].n; k++) {
			double best = INFINITY;
			for (int j = 0; j < GROOVES; j++)
				best = fmin(best, off_groove(&scene_grooves[j], p->line[i].point[k].mm));
			if (best > 1.5)
				fail_msg("a line at (%.1f, %.1f) mm where there is none", p->line[i].point[k].mm[0], p->line[i].point[k].mm[1]);
		}
	wrinkles_free(&w);
	scene_close(&s);
}

/* Light from everywhere alone darkens grooves evenly. */
static void sky_alone(void **state)
{
	(void)state;
	grooves_found(&(struct scene_light){ 0.8, { 0, 0, 0 } });
}

/* A lamp lights one wall and not the other. */
static void sky_and_lamp(void **state)
{
	(void)state;
	grooves_found(&(struct scene_light){ 0.45, { -0.25, 0.3, 0.25 } });
}

/* Moved skin with mole and brow, but no fold. */
static void nothing_folds(void **state)
{
	(void)state;
	struct scene s;
	scene_open(&s, 0, &(struct scene_light){ 0.45, { -0.25, 0.3, 0.25 } });
	struct wrinkles w = { 0 };
	struct err err = { 0 };
	assert_true(wrinkle_find(&w, "still", SCENE_FRAMES, s.frame, &s.ground, &conf, &err));
	assert_int_equal(w.pose[0].n, 0);
	struct image map = wrinkle_bump(&w, &w.pose[0]);
	for (long i = 0; i < (long)SCENE_W * SCENE_H; i++) {
		assert_true(map.px[2 * i] == 0);
		assert_true(map.px[2 * i + 1] == 1);
	}
	image_free(&map);
	wrinkles_free(&w);
	scene_close(&s);
}

/* The map has the groove's height in its middle and at one w beside it; its file says what was found. */
static void bump_map(void **state)
{
	scratch_open();
	const char *path = scratch_path("wrinkles.json");
	(void)state;
	struct scene s;
	scene_open(&s, 1, &(struct scene_light){ 0.8, { 0, 0, 0 } });
	struct wrinkles w = { 0 };
	struct err err = { 0 };
	assert_true(wrinkle_find(&w, "frown", SCENE_FRAMES, s.frame, &s.ground, &conf, &err));
	struct image map = wrinkle_bump(&w, &w.pose[0]);
	double off[3][200];
	int n = 0;
	for (int i = 0; i < GROOVES; i++)
		for (int k = 10; k <= 90; k += 2) {
			const struct groove *g = &scene_grooves[i];
			double a = g->from + (g->to - g->from) * k / 100;
			for (int side = 0; side < 2; side++) {
				double r = g->radius + side * g->width, x = g->center[0] + r * cos(a), y = g->center[1] + r * sin(a);
				double z = scene_ball + scene_away - sqrt(scene_ball * scene_ball - x * x - y * y), h = image_sample(&map, SCENE_W / 2.0 + scene_focal * x / z, SCENE_H / 2.0 - scene_focal * y / z, 0);
				off[side][n] = fabs(h - scene_height(x, y, 1)) / g->depth;
			}
			n++;
		}
	// as the depths themselves; beside the middle, a place half a px off adds a tenth
	NEAR(stats_median(n, off[0]), 0, 0.35);
	NEAR(stats_median(n, off[1]), 0, 0.35);
	assert_true(wrinkles_save(&w, path, 0, &err));
	json_t *json = json_read(path, 1 << 24, &err);
	json_t *pose = json_array_get(json_object_get(json, "expressions"), 0);
	assert_int_equal((int)json_array_size(json_object_get(pose, "lines")), w.pose[0].n);
	json_decref(json);
	image_free(&map);
	wrinkles_free(&w);
	scene_close(&s);
	scratch_close();
}

/* Flat skin sees all of the sky; the bottom of a groove as much as is between its walls; both sides alike. */
static void sky_of_a_groove(void **state)
{
	(void)state;
	NEAR(wrinkle_sky(0.7, 0), 1, 1e-12);
	NEAR(wrinkle_sky(4, 1), 1, 0.02);
	for (double slope = 0.1; slope < 1.5; slope += 0.2) {
		// the wall's steepest line of sight from the bottom: (1 - exp(-x^2 / 2)) / x, most at x^2 + 1 = exp(x^2 / 2)
		double x = 1.5852, rise = slope * (1 - exp(-0.5 * x * x)) / x;
		NEAR(wrinkle_sky(0, slope), 1 / hypot(1, rise), 1e-3);
		NEAR(wrinkle_sky(0.8, slope), wrinkle_sky(-0.8, slope), 1e-12);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(sky_of_a_groove), cmocka_unit_test(sky_alone), cmocka_unit_test(sky_and_lamp),
		cmocka_unit_test(nothing_folds), cmocka_unit_test(bump_map),
	};
	return cmocka_run_group_tests(tests, 0, 0);
}
