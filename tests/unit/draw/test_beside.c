/* Light from beside against closed forms, and the place of the limbus' shadow found again in pictures where it was put. */
#include "draw/eye/march/beside.h"

#include <math.h>
#include <stdlib.h>

#include "base/mem.h"
#include "draw/eye/colour.h"
#include "draw/eye/lighting.h"
#include "draw/eye/make.h"
#include "draw/eye/rim_edge.h"
#include "tests/lib/scenes/plain_scene.h"

static const double id[3][3] = { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } };

/* A scene whose tissue scatters as often as it will. */
static void scene_spreading(struct scene *s)
{
	struct scene_conf conf = conf_of(6);
	struct tissue tissue = scene_plain_tissue;
	scene_of(s, &plain_eye, &conf, even, 0, 1.5);
	tissue.multiple = true;
	scene_set_tissue(s, &tissue);
	scene_rim_make(s);
}

/* A beam from straight above, of power exp(slope x), that entered the cornea at 1 + (x - edge) / radius. */
static struct scene_beams above(const struct scene *s, double slope, double edge)
{
	struct scene_beams beams = { .n = 1, .beam = mem_new(1, sizeof(struct scene_beam)) };
	struct scene_beam *b = beams.beam;
	b->z[0] = (float)s->eye.iris_depth - 1;
	b->z[1] = (float)s->eye.iris_depth + 1;
	b->rgb[0] = b->rgb[1] = b->rgb[2] = 1;
	for (int k = 0; k < 2; k++)
		for (int y = 0; y < SCENE_GRID; y++)
			for (int x = 0; x < SCENE_GRID; x++) {
				double at = (2.0 * x / (SCENE_GRID - 1) - 1) * s->extent;
				float *way = b->way[k][y][x];
				way[2] = -1;
				way[3] = (float)(50 * exp(slope * at));
				way[4] = (float)(1 + (at - edge) / s->limbus[0]);
				way[5] = 1;
			}
	return beams;
}

/* Even light stays as it is; light that falls off as exp(k x) gains 1 / (1 - spread^2 k^2 / 2), red most, whichever way it falls. */
static void falling_light(void **state)
{
	(void)state;
	struct scene s;
	scene_spreading(&s);
	print_message("spread: red %.3f, green %.3f, blue %.3f mm\n", (double)s.spread[0], (double)s.spread[1], (double)s.spread[2]);
	assert_true(s.spread[0] > s.spread[1] && s.spread[1] > s.spread[2] && s.spread[2] > 0.1f);
	for (int way = -1; way <= 1; way++) {
		double k = 1.2 * way;
		struct scene_beams beams = above(&s, k, 100);
		float *got = scene_beside(&s, &beams);
		const float *mid = got + 4 * (SCENE_BESIDE / 2 * SCENE_BESIDE + SCENE_BESIDE / 2);
		for (int c = 0; c < 3; c++) {
			double sigma = (double)s.spread[c], want = 1 / (1 - sigma * sigma * k * k / 2);
			// The tables' nodes lie 0.26 mm apart, linear between: exp(k x) is 0.4 % more in the mean than at the nodes' middle.
			assert_true(fabs((double)mid[c] - want) < (way ? 0.02 * (want - 1) + 0.004 : 1e-5));
		}
		free(got);
		scene_beams_free(&beams);
	}
	scene_free(&s);
}

/* An edge of light that is spread is the limbus' shadow as the march takes it, where both spread alike. */
static void edge_of_light(void **state)
{
	(void)state;
	struct scene s;
	scene_spreading(&s);
	const double sigma = (double)s.rim.spread * s.limbus[0];
	for (int c = 0; c < 3; c++)
		s.spread[c] = (float)(c == 1 ? sigma : (c ? 0.75 : 1.2) * sigma);
	struct scene_beams beams = above(&s, 0, 0);
	float *got = scene_beside(&s, &beams);
	double step = 2 * s.extent / SCENE_BESIDE, worst = 0;
	for (int i = 0; i < SCENE_BESIDE; i++) {
		double x = (i + 0.5) * step - s.extent;
		const float *at = got + 4 * (SCENE_BESIDE / 2 * SCENE_BESIDE + i);
		if (x < -3 || x > 3 * sigma)
			continue;
		worst = fmax(worst, fabs(log((double)at[1])));
		if (x > 0.5 * sigma)
			assert_true(at[0] > at[1] && at[2] < at[1]);
		if (x < -0.5 * sigma && x > -2 * sigma)
			assert_true(at[0] < at[1] && at[2] > at[1]);
	}
	print_message("an edge of light, spread: within %.1f %% of the limbus' shadow\n", 100 * worst);
	assert_true(worst < 0.12);  // texels of two thirds of a spread, where the shadow is down to a hundredth
	free(got);
	scene_beams_free(&beams);
	// Tissue that scatters once leaves light where it is.
	s.spread[0] = s.spread[1] = s.spread[2] = 0;
	beams = above(&s, 0, 0);
	assert_null(scene_beside(&s, &beams));
	scene_beams_free(&beams);
	scene_free(&s);
}

/* What a camera straight before the eye sees of the model with the shadow's edge there, times paint that changes round the axis and with the radius. */
static float *painted(struct scene *s, const double C[3], struct scene_beams *beams, double edge)
{
	const struct scene_level *l = &s->level[0];
	float *texture = mem_array(4 * (size_t)l->n * (size_t)l->n, sizeof *texture);
	s->rim.edge = (float)(1 + edge / s->limbus[0]);
	free(beams->beside);
	beams->beside = scene_beside(s, beams);
	for (int y = 0; y < l->n; y++)
		for (int x = 0; x < l->n; x += BATCH) {
			struct iris_batch b;
			scene_model_row(&b, s, l, x, l->n - x < BATCH ? l->n - x : BATCH, y, C, beams);
			for (int i = 0; i < b.n; i++) {
				double r = hypot((double)b.px[i], (double)b.py[i]), turn = atan2((double)b.py[i], (double)b.px[i]);
				double paint = exp(0.05 * sin(9 * turn) + 0.3 * cos(2 * r));
				for (int c = 0; c < 3; c++)
					texture[4 * ((long)y * l->n + x + i) + c] = (float)(paint * (double)b.rgb[c][i]);
				texture[4 * ((long)y * l->n + x + i) + 3] = 1;
			}
		}
	s->rim.edge = 1;
	return texture;
}

static double found(const float dir[3], double edge)
{
	static const double C[3] = { 0, 0, -170 };
	struct scene s;
	scene_spreading(&s);
	struct scene_lighting light = { .n = 1 };
	light.light[0] = (struct envmap_light){ { dir[0], dir[1], dir[2] }, { 1, 1, 1 } };
	struct scene_beams beams = scene_beams(&s, &light, id);
	float *texture = painted(&s, C, &beams, edge);
	scene_rim_edge_fit(&s, texture, C, &beams);
	double got = ((double)s.rim.edge - 1) * s.limbus[0];
	free(texture);
	scene_beams_free(&beams);
	scene_free(&s);
	return got;
}

/* Light from the side tells the edge; a light on the axis, whose shadow is the same all round, tells nothing, and the prior holds. */
static void edge_found(void **state)
{
	(void)state;
	static const float aside[3] = { -0.4f, -0.5f, -0.768f }, front[3] = { 0, 0, -1 };
	static const double edges[] = { -0.1, 0, 0.12 };
	for (int i = 0; i < 3; i++) {
		double got = found(aside, edges[i]);
		print_message("the shadow's edge, put %.3f mm beyond the limbus: found %.3f\n", edges[i], got);
		assert_true(fabs(got - edges[i]) < 0.015);  // steps of 0.05 mm and a parabola
	}
	double none = found(front, 0.12);
	print_message("under a light on the axis: %.3f\n", none);
	assert_true(fabs(none) < 0.06);  // of 0.1 that the prior allows: what the rings leave of the edge and the paint
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(falling_light), cmocka_unit_test(edge_of_light), cmocka_unit_test(edge_found),
	};
	return cmocka_run_group_tests(tests, 0, 0);
}
