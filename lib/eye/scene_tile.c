/* Light on a tile of the iris: what is smooth across it is looked up at its corners alone. */
#include "eye/scene_march.h"

#include <math.h>

#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC optimize("no-tree-pre", "fp-contract=fast")  // see scene_meet.c, simd.h
#endif

SIMD_CLONES void scene_body_make(struct march_body *b, const struct iris_batch *r, const struct march_tile *tile)
{
	float z = 0, ox = 0, oy = 0, oz = 0;
#pragma omp simd reduction(+ : z, ox, oy, oz)
	for (int i = 0; i < PART; i++) {
		z += r->pz[i] / PART;
		ox += r->span[i] * r->vx[i] / PART;
		oy += r->span[i] * r->vy[i] / PART;
		oz += r->span[i] * r->vz[i] / PART;
	}
	b->tile = tile;
	b->z = z;
	b->over[0] = ox;
	b->over[1] = oy;
	b->over[2] = oz;
	SIMD_LOOP
	for (int i = 0; i < PART; i++) {
		b->q[0][i] = (r->pz[i] - z) / oz;
		b->q[1][i] = (r->pz[i] + r->span[i] * r->vz[i] - z) / oz;
	}
}

/* One channel over the tile: c[face][y][x], at each ray's end. */
SIMD_INLINE void channel_lay(float *restrict out0, float *restrict out1, const float c[8], const struct march_body *restrict b)
{
	for (int y = 0; y < TILE_SIDE; y++) {
		float v = ((float)y + 0.5f) / TILE_SIDE, near = c[0] + v * (c[2] - c[0]), by = c[1] + v * (c[3] - c[1]) - near;
		float far = c[4] + v * (c[6] - c[4]), rise = far - near, more = c[5] + v * (c[7] - c[5]) - far - by;
		const float *restrict q0 = b->q[0] + y * TILE_SIDE, *restrict q1 = b->q[1] + y * TILE_SIDE;
		float *restrict to0 = out0 + y * TILE_SIDE, *restrict to1 = out1 + y * TILE_SIDE;
		SIMD_LOOP
		for (int i = 0; i < TILE_SIDE; i++) {
			float u = ((float)i + 0.5f) / TILE_SIDE, at = near + u * by, up = rise + u * more;
			to0[i] = at + q0[i] * up;
			to1[i] = at + q1[i] * up;
		}
	}
}

/* What light comes; at the limbus, where the sclera begins gradually, less. */
SIMD_CLONES static void power_lay(struct march_light *w, float corner[SCENE_WAY][8], const struct march_body *b, float rim_width)
{
	float rho[2][PART], lo = 1 - rim_width / 2, inv = 1 / rim_width, most = 0;
	channel_lay(w->power[0], w->power[1], corner[3], b);
	for (int k = 0; k < 8; k++)
		most = corner[4][k] > most ? corner[4][k] : most;
	if (most > lo)
		channel_lay(rho[0], rho[1], corner[4], b);
	for (int end = 0; end < 2; end++) {
		float *restrict power = w->power[end], *restrict at = rho[end];
		SIMD_LOOP
		for (int i = 0; i < PART; i++)
			power[i] = power[i] > 0 ? power[i] : 0;
		if (!(most > lo))
			continue;
		SIMD_LOOP
		for (int i = 0; i < PART; i++) {
			float t = (at[i] - lo) * inv;
			t = t > 0 ? t < 1 ? t : 1 : 0;
			power[i] *= 1 - t * t * (3 - 2 * t);
		}
	}
}

SIMD_CLONES static void lay(struct march_light *w, float corner[SCENE_WAY][8], const struct march_body *b)
{
	channel_lay(w->x[0], w->x[1], corner[0], b);
	channel_lay(w->y[0], w->y[1], corner[1], b);
	channel_lay(w->z[0], w->z[1], corner[2], b);
}

SIMD_CLONES static void shade(struct march_light *w, const float *restrict low, const float *restrict high, float part)
{
	const float *restrict lx = w->x[0], *restrict ly = w->y[0], *restrict lz = w->z[0];
	SIMD_LOOP
	for (int i = 0; i < PART; i++) {
		float rise = -lz[i] / sqrtf(lx[i] * lx[i] + ly[i] * ly[i] + 1e-12f);
		float open = scene_shadow_open(rise - (low[i] + part * (high[i] - low[i])));
		w->power[0][i] *= open;
		w->power[1][i] *= open;
	}
}

/* Slope of the lowest of a light's directions over the tile, and whether there is any light. */
static bool lowest(float *slope, float corner[SCENE_WAY][8], float width)
{
	bool any = false;
	*slope = 1e3f;
	for (int k = 0; k < 8; k++) {
		float flat = sqrtf(corner[0][k] * corner[0][k] + corner[1][k] * corner[1][k]);
		*slope = -corner[2][k] < *slope * flat ? -corner[2][k] / flat : *slope;
		any = any || (corner[3][k] > 0 && corner[4][k] < 1 + width / 2);
	}
	return any;
}

/* Azimuth of x, y in parts of a turn, 0..n, to 3e-4 rad. */
SIMD_INLINE float turn_of(float x, float y, float n)
{
	float ax = fabsf(x), ay = fabsf(y), low = ax < ay ? ax : ay, high = (ax < ay ? ay : ax) + 1e-20f, t = low / high;
	float part = t * (0.1594643f + t * (-0.0015261f + t * (-0.0560489f + t * 0.0231544f)));
	part = ax < ay ? 0.25f - part : part;
	part = x < 0 ? 0.5f - part : part;
	return n * (y < 0 ? 1 - part : part);
}

bool scene_light_tile(struct march_light *light, const struct march_body *body, const struct scene *s, const struct scene_beam *beam)
{
	const struct march_tile *tile = body->tile;
	float corner[SCENE_WAY][8], side = TILE_SIDE * tile->step, width = (float)(s->conf.limbus_width / s->limbus[0]), low;
	for (int k = 0; k < 8; k++) {
		float far = k < 4 ? 0 : 1, way[SCENE_WAY], p[3];
		p[0] = tile->x + (k & 1 ? side : 0) + far * body->over[0];
		p[1] = tile->y + (k & 2 ? side : 0) + far * body->over[1];
		p[2] = body->z + far * body->over[2];
		scene_table_at(way, beam, p, (float)s->extent);
		for (int c = 0; c < 5; c++)
			corner[c][k] = way[c];
	}
	if (!lowest(&low, corner, width))
		return false;
	lay(light, corner, body);
	power_lay(light, corner, body, width);
	if (!tile->horizon)
		return true;
	float turn = turn_of(corner[0][0] + corner[0][3], corner[1][0] + corner[1][3], HORIZONS);
	int whole = (int)turn, a = whole % HORIZONS, b = (a + 1) % HORIZONS;
	const struct march_horizon *h = tile->horizon;
	float steepest = h->steepest[a] > h->steepest[b] ? h->steepest[a] : h->steepest[b];
	if (low - steepest < SCENE_SOURCE)
		shade(light, h->slope[a], h->slope[b], turn - (float)whole);
	return true;
}
