/* Light on a tile of the iris: what is smooth across it is looked up at the corners of the tile's body alone. */
#include "draw/eye/march/march.h"

#include <math.h>

#include "draw/eye/make.h"

#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC optimize("no-tree-pre", "fp-contract=fast")  // see meet.c, simd.h
#endif

/* Places the body's corners in the beams' tables, which all have the same planes. */
SIMD_INLINE void corners_place(struct march_body *b, float side, float extent, const double plane[2])
{
	float per = (SCENE_GRID - 1) / (2 * extent), top = SCENE_GRID - 1.001f, z0 = (float)plane[0], thick = 1 / (float)(plane[1] - plane[0]);
	SIMD_LOOP
	for (int k = 0; k < 8; k++) {
		float far = k < 4 ? 0 : 1, x = b->tile->x + (k & 1 ? side : 0) + far * b->over[0], y = b->tile->y + (k & 2 ? side : 0) + far * b->over[1];
		float u = (x + extent) * per, v = (y + extent) * per, q = (b->z + far * b->over[2] - z0) * thick, r = 1 - q;
		u = u > 0 ? u < top ? u : top : 0;
		v = v > 0 ? v < top ? v : top : 0;
		int iu = (int)u, iv = (int)v;
		u -= (float)iu;
		v -= (float)iv;
		b->node[k] = iv * SCENE_GRID + iu;
		const float w[4] = { (1 - u) * (1 - v), u * (1 - v), (1 - u) * v, u * v };
#pragma GCC unroll 4
		for (int j = 0; j < 4; j++) {
			b->of_near[k][j] = r * w[j];
			b->of_far[k][j] = q * w[j];
		}
	}
}

SIMD_CLONES void scene_body_make(struct march_body *b, const struct iris_batch *r, const struct march_tile *tile, const struct scene *s)
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
	double plane[2];
	scene_planes(plane, s);
	corners_place(b, TILE_SIDE * tile->step, (float)s->extent, plane);
}

/* A beam's channels at the body's corners. */
SIMD_CLONES static void corners_read(float (*restrict corner)[8], const struct march_body *restrict b, const struct scene_beam *restrict beam)
{
	float way[8][SCENE_WAY];
	for (int k = 0; k < 8; k++) {
		const way_vector *p = (const way_vector *)beam->way[0][0] + b->node[k], *q = (const way_vector *)beam->way[1][0] + b->node[k];
		const float *n = b->of_near[k], *f = b->of_far[k];
		*(way_vector *)way[k] = n[0] * p[0] + n[1] * p[1] + n[2] * p[SCENE_GRID] + n[3] * p[SCENE_GRID + 1]
		                        + (f[0] * q[0] + f[1] * q[1] + f[2] * q[SCENE_GRID] + f[3] * q[SCENE_GRID + 1]);
	}
	for (int c = 0; c < 5; c++)
		for (int k = 0; k < 8; k++)
			corner[c][k] = way[k][c];
}

/* One channel over the tile, c[face][y][x]: on the near face, and what it changes by to the far one. */
SIMD_INLINE void channel_lay(float *restrict out, float *restrict change, const float c[8])
{
	for (int y = 0; y < TILE_SIDE; y++) {
		float v = ((float)y + 0.5f) / TILE_SIDE, near = c[0] + v * (c[2] - c[0]), by = c[1] + v * (c[3] - c[1]) - near;
		float far = c[4] + v * (c[6] - c[4]), rise = far - near, more = c[5] + v * (c[7] - c[5]) - far - by;
		float *restrict to = out + y * TILE_SIDE, *restrict by_to = change + y * TILE_SIDE;
		SIMD_LOOP
		for (int i = 0; i < TILE_SIDE; i++) {
			float u = ((float)i + 0.5f) / TILE_SIDE;
			to[i] = near + u * by;
			by_to[i] = rise + u * more;
		}
	}
}

/* Channel 4, where the light enters the cornea, becomes its place on the limbus' ramp. */
SIMD_CLONES static void rim_lay(float (*restrict corner)[8], const struct march_body *restrict b, const struct rim_shadow *restrict rim)
{
	float side = TILE_SIDE * b->tile->step;
	SIMD_LOOP
	for (int k = 0; k < 8; k++) {
		float far = k < 4 ? 0 : 1, x = b->tile->x + (k & 1 ? side : 0) + far * b->over[0], y = b->tile->y + (k & 2 ? side : 0) + far * b->over[1];
		corner[4][k] = rim_shadow_at(rim, corner[4][k], x, y, b->z + far * b->over[2], corner[0][k], corner[1][k], corner[2][k]);
	}
}

/* Irradiance at both ends of the rays, reduced by the limbus, where the sclera begins gradually: as at the near end (struct march_light). */
SIMD_CLONES static void power_lay(struct march_light *restrict w, float corner[SCENE_WAY][8], const struct march_body *restrict b, const struct rim_shadow *restrict rim)
{
	float at[2][PART], most = -1e3f, *restrict p0 = w->power[0], *restrict p1 = w->power[1];
	channel_lay(p0, p1, corner[3]);
	SIMD_LOOP
	for (int i = 0; i < PART; i++) {
		float a = p0[i] + b->q[0][i] * p1[i], c = p0[i] + b->q[1][i] * p1[i];
		p0[i] = a > 0 ? a : 0;
		p1[i] = c > 0 ? c : 0;
	}
	for (int k = 0; k < 8; k++)
		most = corner[4][k] > most ? corner[4][k] : most;
	if (!(most > -RIM_SHADOW_MOST))
		return;
	channel_lay(at[0], at[1], corner[4]);
	SIMD_LOOP
	for (int i = 0; i < PART; i++) {
		float open = rim_shadow_open(rim, at[0][i] + b->q[0][i] * at[1][i]);
		p0[i] *= open;
		p1[i] *= open;
	}
}

SIMD_CLONES static void lay(struct march_light *w, float corner[SCENE_WAY][8])
{
	channel_lay(w->x[0], w->x[1], corner[0]);
	channel_lay(w->y[0], w->y[1], corner[1]);
	channel_lay(w->z[0], w->z[1], corner[2]);
}

/* Dims the light by the relief's horizon at the near ends. low, high: slopes in the two nearest azimuths; part: between them. */
SIMD_CLONES static void shade(struct march_light *w, const struct march_body *b, const float *restrict low, const float *restrict high, float part)
{
	SIMD_LOOP
	for (int i = 0; i < PART; i++) {
		float q = b->q[0][i], x = w->x[0][i] + q * w->x[1][i], y = w->y[0][i] + q * w->y[1][i], z = w->z[0][i] + q * w->z[1][i];
		float open = scene_shadow_open(-z / sqrtf(x * x + y * y + 1e-12f) - (low[i] + part * (high[i] - low[i])));
		w->power[0][i] *= open;
		w->power[1][i] *= open;
	}
}

SIMD_CLONES static void power_change(struct march_light *w)
{
	SIMD_LOOP
	for (int i = 0; i < PART; i++)
		w->power[1][i] -= w->power[0][i];
}

/* Slope of the lowest of a light's directions over the tile, and whether there is any light. */
SIMD_CLONES static bool lowest(float *slope, float (*restrict corner)[8])
{
	int any = 0;
	float least = 1e3f;
#pragma omp simd reduction(min : least) reduction(| : any)
	for (int k = 0; k < 8; k++) {
		float s = -corner[2][k] / sqrtf(corner[0][k] * corner[0][k] + corner[1][k] * corner[1][k] + 1e-12f);
		least = s < least ? s : least;
		any |= (corner[3][k] > 0) & (corner[4][k] < RIM_SHADOW_MOST);
	}
	*slope = least;
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
	float corner[SCENE_WAY][8], low;
	const struct march_horizon *h = body->tile->horizon;
	corners_read(corner, body, beam);
	rim_lay(corner, body, &s->rim);
	if (!lowest(&low, corner))
		return false;
	lay(light, corner);
	power_lay(light, corner, body, &s->rim);
	if (h) {
		float turn = turn_of(corner[0][0] + corner[0][3], corner[1][0] + corner[1][3], HORIZONS);
		int whole = (int)turn, a = whole % HORIZONS, b = (a + 1) % HORIZONS;
		float steepest = h->steepest[a] > h->steepest[b] ? h->steepest[a] : h->steepest[b];
		if (low - steepest < SCENE_SOURCE)
			shade(light, body, h->slope[a], h->slope[b], turn - (float)whole);
	}
	power_change(light);
	return true;
}
