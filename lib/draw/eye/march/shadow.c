/* Shadow of the relief on itself, by horizons: light is hidden where the relief rises more steeply than the light's direction. */
#include "draw/eye/march/march.h"

#include <math.h>
#include <stdlib.h>

#include "base/mem.h"

#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC optimize("no-tree-pre", "fp-contract=fast")  // see meet.c, simd.h
#endif

static const float bias = (float)LOOK_BIAS;  // mm: a surface does not shadow itself

/* Raises the steepest slope by what is seen at the share `part` of the distance at which a light ray leaves the relief. */
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

/* Heights of a level alone, padded by repeating its edge, so that lookups need no bounds. */
struct heights {
	float *px;
	int stride, pad;
};

static struct heights heights_make(const struct scene_level *l, float reach)
{
	int pad = (int)(reach * l->per_mm) + 2 + TILE_SIDE, stride = l->n + 2 * pad;
	struct heights h = { mem_array((size_t)stride * (size_t)stride, sizeof *h.px), stride, pad };
	for (int y = 0; y < stride; y++)
		for (int x = 0; x < stride; x++) {
			int u = x - pad, v = y - pad;
			u = u < 0 ? 0 : u < l->n ? u : l->n - 1;
			v = v < 0 ? 0 : v < l->n ? v : l->n - 1;
			h.px[(long)y * stride + x] = l->relief[2 * ((long)v * l->n + u)];
		}
	return h;
}

/* All texels of a tile look in the same direction and as far: they share the four bilinear weights. */
SIMD_CLONES
static void tile_look(float *restrict steepest, const float *restrict at, long stride, const float off[2], float distance, float per_distance, float top)
{
	float fu = floorf(off[0]), fv = floorf(off[1]), u = off[0] - fu, v = off[1] - fv;
	const float *restrict seen = at + (long)fv * stride + (long)fu;
	float a = (1 - v) * (1 - u), b = (1 - v) * u, c = v * (1 - u), d = v * u;
	for (int y = 0; y < TILE_SIDE; y++) {
		const float *restrict p = seen + y * stride, *restrict q = p + stride, *restrict own = at + y * stride;
		float *restrict out = steepest + y * TILE_SIDE;
		SIMD_LOOP
		for (int x = 0; x < TILE_SIDE; x++) {
			float slope = (a * p[x] + b * p[x + 1] + c * q[x] + d * q[x + 1] - own[x] - bias) * per_distance;
			out[x] = 0.5f * distance < top - own[x] && slope > out[x] ? slope : out[x];  // beyond, none is above one half
		}
	}
}

/* Slopes that a tile's texels see in all azimuths, at distances that grow by a quarter from a texel on. */
static void tile_horizons(struct march_horizon *out, const struct scene_level *l, const struct heights *h, int tx, int ty, float top, float reach)
{
	const float *at = h->px + (long)(ty * TILE_SIDE + h->pad) * h->stride + tx * TILE_SIDE + h->pad;
	float low = top, step = 1 / l->per_mm;
	for (int i = 0; i < PART; i++)
		low = fminf(low, at[(long)(i / TILE_SIDE) * h->stride + i % TILE_SIDE]);
	for (int a = 0; a < HORIZONS; a++) {
		float turn = (float)(2 * M_PI) * (float)a / HORIZONS, c = cosf(turn), s = sinf(turn);
		for (int i = 0; i < PART; i++)
			out->slope[a][i] = -1;
		for (float off = step; off * 0.5f < top - low && off < reach; off += fmaxf(step, 0.25f * off))
			tile_look(out->slope[a], at, h->stride, (const float[2]){ off * c * l->per_mm, off * s * l->per_mm }, off, 1 / off, top);
		out->steepest[a] = -1;
		for (int i = 0; i < PART; i++)
			out->steepest[a] = fmaxf(out->steepest[a], out->slope[a][i]);
	}
}

struct march_horizon *scene_horizons(const struct scene *s, const struct scene_level *l)
{
	int tiles = (l->n + TILE_SIDE - 1) / TILE_SIDE;
	struct march_horizon *out = mem_array((size_t)tiles * (size_t)tiles, sizeof *out);
	float reach = fminf(2 * (s->height_max - s->height_min), 2 * (float)s->extent);
	struct heights heights = heights_make(l, reach);
#pragma omp parallel for schedule(dynamic, 8)
	for (int i = 0; i < tiles * tiles; i++)
		tile_horizons(&out[i], l, &heights, i % tiles, i / tiles, s->height_max, reach);
	free(heights.px);
	return out;
}
