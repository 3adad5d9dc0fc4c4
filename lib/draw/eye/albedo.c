#include "draw/eye/albedo.h"

#include <math.h>
#include <stdlib.h>

#include "draw/eye/colour.h"
#include "draw/eye/lighting.h"

/* Rows of a map that is even, and the beams that stand for it. */
enum { ROWS = 16, BEAMS = 12, EACH = 8, TURNS = 4, APART = 8 };  // APART: rows between those that a mean is taken over
static const double same[3][3] = { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } }, far_off[3] = { 0, 0, -1e4 };

/* The colours of texels x .. of a row under a light. */
static void row_of(struct iris_batch *b, const struct scene *s, int x, int y, const struct scene_beams *beams)
{
	const struct scene_level *level = &s->level[0];
	scene_model_row(b, s, level, x, level->n - x < BATCH ? level->n - x : BATCH, y, far_off, beams);
	for (int i = 0; i < b->n; i++) {
		float rgb[3] = { b->rgb[0][i], b->rgb[1][i], b->rgb[2][i] };
		scene_colour(rgb, s, level, b->px[i], b->py[i], beams->own);
		for (int c = 0; c < 3; c++)
			b->rgb[c][i] = rgb[c];
	}
}

/* Mean colour of the iris under a light, over the irradiance (over pi) of a plane across the axis. */
static void mean_under(double mean[3], const struct scene *s, const struct scene_lighting *light)
{
	struct scene_beams beams = scene_beams(s, light, same);
	double sum[3] = { 0 }, on[3] = { 0 };
	for (int k = 0; k < light->n; k++)
		for (int c = 0; c < 3; c++)
			on[c] += fmax(-light->light[k].dir[2], 0) * light->light[k].rgb[c];
	for (int y = APART / 2; y < s->level[0].n; y += APART)
		for (int x = 0; x < s->level[0].n; x += BATCH) {
			struct iris_batch b;
			row_of(&b, s, x, y, &beams);
			for (int i = 0; i < b.n; i++)
				for (int c = 0; c < 3; c++)
					sum[c] += b.rgb[c][i];
		}
	for (int c = 0; c < 3; c++)
		mean[c] = sum[c] / fmax(on[c], 1e-9);
	scene_beams_free(&beams);
}

/* How much brighter the iris is under `lit` than its albedo in even light makes a diffuse surface (lamps that stand aside light a layer that
 * scatters less than they light such a surface), and half of that, in stops: no albedo is right in both. Of the light turned round the axis, as no side is to be in it. */
static void gain_under(double gain[3], const struct scene *s, const struct scene_lighting *even, const struct envmap *lit)
{
	double in_even[3], sum[3] = { 0 };
	struct scene_lighting light = scene_lighting_of(lit, 0, BEAMS, EACH);
	mean_under(in_even, s, even);
	for (int turn = 0; turn < TURNS; turn++) {
		double mean[3];
		mean_under(mean, s, &light);
		for (int c = 0; c < 3; c++)
			sum[c] += mean[c] / TURNS;
		for (int k = 0; k < light.n; k++) {
			float *d = light.light[k].dir, x = d[0];
			d[0] = -d[1];
			d[1] = x;
		}
	}
	for (int c = 0; c < 3; c++)
		gain[c] = in_even[c] > 0 ? sqrt(fmin(fmax(sum[c] / in_even[c], 0.5), 2)) : 1;
}

struct image scene_albedo(const struct scene *s, const struct envmap *lit)
{
	static const double even[3] = { 1, 1, 1 };
	double gain[3];
	const struct scene_level *level = &s->level[0];
	struct envmap env = envmap_room(ROWS, even, even, 1, 0, 0);
	envmap_normalise(&env);
	struct scene_lighting light = scene_lighting_of(&env, 0, BEAMS, EACH);
	struct scene_beams beams = scene_beams(s, &light, same);
	struct image out = image_new(level->n, level->n, 3);
	gain_under(gain, s, &light, lit);
#pragma omp parallel for schedule(dynamic, 8)
	for (int y = 0; y < level->n; y++)
		for (int x = 0; x < level->n; x += BATCH) {
			struct iris_batch b;
			row_of(&b, s, x, y, &beams);
			for (int i = 0; i < b.n; i++)
				for (int c = 0; c < 3; c++)
					image_at(&out, x + i, y)[c] = fminf(fmaxf((float)gain[c] * b.rgb[c][i], 0), 1);
		}
	scene_beams_free(&beams);
	envmap_free(&env);
	return out;
}
