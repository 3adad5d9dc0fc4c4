/* The margin of the pupil. */
#include <math.h>
#include <stdlib.h>

#include "base/mem.h"
#include "draw/eye/impl.h"

/* How much of a point of the iris plane is iris; *ruff how much is the dark ruff. */
static float margin(const struct scene *s, float x, float y, float soft, float *ruff)
{
	float dx = x - (float)s->pupil[0], dy = y - (float)s->pupil[1], r = sqrtf(dx * dx + dy * dy), off = r - (float)s->pupil[2];
	*ruff = 0;
	if (fabsf(off) > 0.2f + 2 * soft)
		return off > 0;
	float turn = atan2f(dy, dx);
	// The ridges of the ruff: about 70 round the margin, of uneven height (iris paper, section 2.2).
	float ridge = 0.6f * fabsf(sinf(34 * turn + 1.7f * sinf(5 * turn))) + 0.4f * fabsf(sinf(21 * turn + 2 * sinf(3 * turn + 1)));
	float edge = (float)s->pupil[2] - (float)LOOK_RUFF_RIDGE * ridge, width = (float)LOOK_RUFF_WIDTH + (float)LOOK_RUFF_MORE * ridge;
	*ruff = 1 - smooth(edge + width - soft, edge + width + (float)LOOK_RUFF_SOFT + soft, r);
	return smooth(edge - (float)LOOK_RUFF_BLUR - soft, edge + (float)LOOK_RUFF_BLUR + soft, r);
}

void scene_pupil(float cover[3], const struct scene *s, float x, float y, float soft)
{
	static const float dark[3] = { LOOK_RUFF_COLOUR };  // what the pigment of the ruff leaves of the colour
	float ruff, iris = margin(s, x, y, soft, &ruff);
	for (int c = 0; c < 3; c++)
		cover[c] = iris * (1 + (float)LOOK_RUFF_SHARE * ruff * (dark[c] - 1));
}

void scene_shown_make(struct scene_level *l, const struct scene *s)
{
	float step = 1 / l->per_mm, extent = (float)s->extent, detail = (float)s->conf.detail;
	float *shown = mem_array((size_t)l->n * (size_t)l->n, 4 * sizeof *shown), *bare = mem_array((size_t)l->n * (size_t)l->n, 4 * sizeof *bare);
#pragma omp parallel for schedule(dynamic, 16)
	for (int y = 0; y < l->n; y++)
		for (int x = 0; x < l->n; x++) {
			float cover[3];
			long at = 4 * ((long)y * l->n + x);
			scene_pupil(cover, s, ((float)x + 0.5f) * step - extent, ((float)y + 0.5f) * step - extent, 0.5f * step);
			for (int c = 0; c < 3; c++) {
				float colour = l->colour[at + c];
				shown[at + c] = cover[c] * (!l->model ? 1 : detail == 1 ? colour : powf(colour, detail));
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

/* Pairs of what `height` says of texels; the last one of a row repeats. */
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
