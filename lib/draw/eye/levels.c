#include "draw/eye/levels.h"

#include <math.h>
#include <stdlib.h>

#include "base/mem.h"
#include "draw/eye/march/march.h"
#include "draw/eye/texels.h"

int scene_marched(const struct scene *s)
{
	// A map below the full size is marched from as many texels as a full one, to within a fifth.
	int apart = s->conf.apart > 0 ? s->conf.apart : 2, enough = s->conf.map_size / apart * 6 / 5, k = 0;
	for (int step = apart; step > 1 && k + 1 < s->n_levels && s->level[0].n >> k > enough; step /= 2)
		k++;
	return k;
}

static float *halve(const float *map, int n, int channels)
{
	int m = n / 2;
	float *out = mem_array((size_t)m * (size_t)m * (size_t)channels, sizeof *out);
	for (int y = 0; y < m; y++)
		for (int x = 0; x < m; x++)
			for (int c = 0; c < channels; c++) {
				const float *p = map + ((long)2 * y * n + 2 * x) * channels + c;
				out[((long)y * m + x) * channels + c] = (p[0] + p[channels] + p[(long)n * channels] + p[(long)(n + 1) * channels]) / 4;
			}
	return out;
}

/* Light is tabulated on two planes and interpolated between them: they lie as close as the tissue allows, or the light of the far side,
 * which falls steeply with depth, comes out too bright. */
static void ranges_find(struct scene *s)
{
	const struct scene_level *l = s->level;
	s->height_min = s->height_max = 0;
	s->tissue_range[0] = s->tissue_range[1] = 0;
	for (long i = 0; i < (long)l->n * l->n; i++) {
		float top = l->relief[2 * i], bottom = top - l->relief[2 * i + 1];
		double x = ((double)(i % l->n) + 0.5) / l->per_mm - s->extent, y = ((double)(i / l->n) + 0.5) / l->per_mm - s->extent;
		s->height_min = fminf(s->height_min, top);
		s->height_max = fmaxf(s->height_max, top);
		if (hypot(x - s->pupil[0], y - s->pupil[1]) < s->pupil[2] || hypot(x, y) > s->limbus[0])
			continue;
		s->tissue_range[0] = fminf(s->tissue_range[0], bottom);
		s->tissue_range[1] = fmaxf(s->tissue_range[1], top);
	}
}

void scene_levels_make(struct scene *s)
{
	struct scene_level *l = s->level;
	ranges_find(s);
	s->n_levels = 1;
	for (int k = 1; k < SCENE_LEVELS && l[k - 1].n >= 64; k++, s->n_levels++) {
		free(l[k].relief);
		free(l[k].colour);
		free(l[k].model);
		free(l[k].per_model);
		free(l[k].horizon);
		free(l[k].pairs);
		free(l[k].bottom);
		free(l[k].shown.px);
		free(l[k].bare.px);
		l[k] = (struct scene_level){ .n = l[k - 1].n / 2, .per_mm = (float)(l[k - 1].n / 2 / (2 * s->extent)) };
		l[k].relief = halve(l[k - 1].relief, l[k - 1].n, 2);
		l[k].colour = halve(l[k - 1].colour, l[k - 1].n, 4);
		l[k].model = l[k - 1].model ? halve(l[k - 1].model, l[k - 1].n, 4) : 0;
	}
	for (int k = 0; k < s->n_levels && s->conf.shading == SCENE_TEXELS; k++) {
		free(l[k].horizon);
		l[k].horizon = s->conf.shadow > 0 && k >= scene_marched(s) ? scene_horizons(s, &l[k]) : 0;
		scene_pairs_make(&l[k], k >= scene_marched(s));
		scene_shown_make(&l[k], s);
	}
}

void scene_set_detail(struct scene *s, double detail)
{
	s->conf.detail = detail;
	for (int k = 0; k < s->n_levels && s->conf.shading == SCENE_TEXELS; k++)
		scene_shown_make(&s->level[k], s);
}

const struct scene_level *scene_level_for(const struct scene *s, double mm)
{
	int k = 0;
	while (k + 1 < s->n_levels && s->level[k + 1].per_mm * mm > 0.8)
		k++;
	return &s->level[k];
}
