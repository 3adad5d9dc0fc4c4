#include "draw/eye/texels.h"

#include <math.h>
#include <stdlib.h>

#include "base/mem.h"
#include "draw/eye/pupil.h"
#include "draw/eye/tint.h"

void scene_texels_make(struct scene_texels *out, const float *rgba, int n)
{
	float most = 1e-6f;
	int stride = n + 8;
	long count = 4L * n * n;
	for (long i = 0; i < count; i++)
		most = i % 4 < 3 && rgba[i] > most ? rgba[i] : most;
	free(out->px);
	*out = (struct scene_texels){ n, stride, most / 65535, mem_array(4 * (size_t)n * (size_t)stride, sizeof *out->px) };
#pragma omp parallel for schedule(static)
	for (long i = 0; i < count; i++)
		out->px[i + i / (4 * n) * 4 * (stride - n)] = i % 4 < 3 ? (uint16_t)lrintf(fmaxf(rgba[i], 0) / out->step) : 0;
}

void scene_shown_make(struct scene_level *l, const struct scene *s)
{
	float step = 1 / l->per_mm, extent = (float)s->extent, detail = (float)s->conf.detail;
	float *shown = mem_array((size_t)l->n * (size_t)l->n, 4 * sizeof *shown), *bare = mem_array((size_t)l->n * (size_t)l->n, 4 * sizeof *bare);
#pragma omp parallel for schedule(dynamic, 16)
	for (int y = 0; y < l->n; y++)
		for (int x = 0; x < l->n; x++) {
			float cover[3], tint[3] = { 1, 1, 1 };
			long at = 4 * ((long)y * l->n + x);
			float u = ((float)x + 0.5f) * step - extent, v = ((float)y + 0.5f) * step - extent;
			scene_pupil(cover, s, u, v, 0.5f * step);
			if (detail < 1)
				scene_tint_at(tint, s, u, v);
			for (int c = 0; c < 3; c++) {
				float colour = l->colour[at + c];
				shown[at + c] = cover[c] * (!l->model ? 1 : detail == 1 ? colour : powf(colour, detail) * powf(tint[c], 1 - detail));
				bare[at + c] = cover[c] * (l->model ? fminf(colour / l->model[at + c], 4) : 1);
			}
		}
	scene_texels_make(&l->shown, shown, l->n);
	scene_texels_make(&l->bare, bare, l->n);
	free(shown);
	free(bare);
}

static int pair_half(float height)
{
	return (int)lrintf(fmaxf(-32768, fminf(32767, height / SCENE_PAIR_MM)));
}

/* Pairs of the values that `height` returns of neighbouring texels; the last one of a row repeats. */
static int *pairs_of(const struct scene_level *l, float height(const float relief[2]))
{
	int stride = SCENE_PAIR_STRIDE(l->n), *out = mem_array((size_t)l->n * (size_t)stride, sizeof *out);
	for (int y = 0; y < l->n; y++)
		for (int x = 0; x < stride; x++) {
			int last = l->n - 1, at = x < last ? x : last, next = x + 1 < last ? x + 1 : last;
			const float *row = l->relief + 2 * (long)y * l->n;
			unsigned low = (unsigned)pair_half(height(row + 2 * at)) & 0xffff, high = (unsigned)pair_half(height(row + 2 * next));
			out[(long)y * stride + x] = (int)(high << 16 | low);
		}
	return out;
}

static float top_of(const float relief[2])
{
	return relief[0];
}

static float half_bottom_of(const float relief[2])
{
	return 0.5f * (relief[0] - relief[1]);
}

void scene_pairs_make(struct scene_level *l, bool marched)
{
	free(l->pairs);
	free(l->bottom);
	l->pairs = pairs_of(l, top_of);
	l->bottom = marched ? pairs_of(l, half_bottom_of) : 0;
}
