/* Shadow of the relief on itself: light is hidden by what stands under a steeper slope than it comes from. */
#include "eye/scene_march.h"

#include <math.h>
#include <stdlib.h>

#include "base/mem.h"

#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC optimize("no-tree-pre")  // see scene_meet.c
#endif

static const float bias = (float)LOOK_BIAS;  // mm: a surface does not shadow itself

/* The steepest slope so far, looking at the part `part` of the way out of the relief's reach. */
SIMD_CLONES
static void look_out(int n, float *restrict steepest, const struct march_light *m, const float *restrict px,
                     const float *restrict py, const float *restrict pz, const struct ground *g, float part)
{
	const float *restrict lx = m->x[0], *restrict ly = m->y[0], *restrict lz = m->z[0], *restrict relief = g->relief;
	float per_mm = g->per_mm, z_plane = g->z_plane, z_high = g->z_high;
	int size = g->size;
	SIMD_LOOP
	for (int i = 0; i < n; i++) {
		float gx, gy, up = lz[i] < -0.05f ? lz[i] : -0.05f, t = part * (z_high - pz[i]) / up;  // mm of the way
		float h = z_plane - relief_at(relief, size, per_mm, px[i] + t * lx[i], py[i] + t * ly[i], &gx, &gy);
		float slope = (pz[i] - h - bias) / (t * sqrtf(lx[i] * lx[i] + ly[i] * ly[i]) + 1e-6f), old = steepest[i];
		steepest[i] = slope > old ? slope : old;
	}
}

void scene_shadow(struct march_light *m, int n, const float *x, const float *y, const float *z, const struct ground *g,
                  int steps)
{
	float steepest[PART];
	for (int i = 0; i < n; i++)
		steepest[i] = -1e3f;
	for (int k = 1; k <= steps; k++)
		look_out(n, steepest, m, x, y, z, g, (float)k / (float)steps);
	for (int i = 0; i < n; i++) {
		float rise = -m->z[0][i] / sqrtf(m->x[0][i] * m->x[0][i] + m->y[0][i] * m->y[0][i] + 1e-12f);
		float open = scene_shadow_open(rise - steepest[i]);
		m->power[0][i] *= open;
		m->power[1][i] *= open;
	}
}

/* Slopes seen from one texel towards azimuth (cos, sin), at distances that grow by a quarter from a texel on. */
static float horizon_at(const struct scene_level *l, float x, float y, float c, float s, float h, float top)
{
	float steepest = -1, step = 1 / l->per_mm, gx, gy;
	for (float off = step; off * 0.5f < top - h; off += fmaxf(step, 0.25f * off)) {  // beyond, none is above one half
		float rise = relief_at(l->relief, l->n, l->per_mm, x + off * c, y + off * s, &gx, &gy) - h - bias;
		steepest = fmaxf(steepest, rise / off);
	}
	return steepest;
}

static void tile_horizons(float (*out)[PART], const struct scene_level *l, int tx, int ty, float extent, float top)
{
	for (int i = 0; i < PART; i++) {
		int x = tx * TILE_SIDE + i % TILE_SIDE, y = ty * TILE_SIDE + i / TILE_SIDE;
		x = x < l->n ? x : l->n - 1;
		y = y < l->n ? y : l->n - 1;
		float h = l->relief[2 * ((long)y * l->n + x)], u = ((float)x + 0.5f) / l->per_mm - extent, v = ((float)y + 0.5f) / l->per_mm - extent;
		for (int a = 0; a < HORIZONS; a++)
			out[a][i] = horizon_at(l, u, v, cosf((float)(2 * M_PI) * (float)a / HORIZONS), sinf((float)(2 * M_PI) * (float)a / HORIZONS), h, top);
	}
}

float *scene_horizons(const struct scene *s, const struct scene_level *l)
{
	int tiles = (l->n + TILE_SIDE - 1) / TILE_SIDE;
	float(*out)[HORIZONS][PART] = mem_array((size_t)tiles * (size_t)tiles, sizeof *out);
#pragma omp parallel for schedule(dynamic)
	for (int i = 0; i < tiles * tiles; i++)
		tile_horizons(out[i], l, i % tiles, i / tiles, (float)s->extent, s->height_max);
	return &out[0][0][0];
}
