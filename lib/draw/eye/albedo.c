#include "draw/eye/albedo.h"

#include <math.h>
#include <stdlib.h>

#include "draw/eye/colour.h"
#include "draw/eye/lighting.h"

/* Rows of a map that is even, and the beams that stand for it. */
enum { ROWS = 16, BEAMS = 12, EACH = 8 };

struct image scene_albedo(const struct scene *s)
{
	static const double even[3] = { 1, 1, 1 }, same[3][3] = { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } }, C[3] = { 0, 0, -1e4 };
	const struct scene_level *level = &s->level[0];
	struct envmap env = envmap_room(ROWS, even, even, 1, 0, 0);
	envmap_normalise(&env);
	struct scene_lighting light = scene_lighting_of(&env, 0, BEAMS, EACH);
	struct scene_beams beams = scene_beams(s, &light, same);
	struct image out = image_new(level->n, level->n, 3);
#pragma omp parallel for schedule(dynamic, 8)
	for (int y = 0; y < level->n; y++)
		for (int x = 0; x < level->n; x += BATCH) {
			struct iris_batch b;
			scene_model_row(&b, s, level, x, level->n - x < BATCH ? level->n - x : BATCH, y, C, &beams);
			for (int i = 0; i < b.n; i++) {
				float *rgb = image_at(&out, x + i, y);
				for (int c = 0; c < 3; c++)
					rgb[c] = b.rgb[c][i];
				scene_colour(rgb, s, level, b.px[i], b.py[i]);
				for (int c = 0; c < 3; c++)
					rgb[c] = fminf(fmaxf(rgb[c], 0), 1);
			}
		}
	free(beams.beam);
	envmap_free(&env);
	return out;
}
