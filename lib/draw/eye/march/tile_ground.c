/* Rays of sight below a tile's texels, on maps of pairs: half as many reads as of the maps themselves. */
#include <math.h>

#include "draw/eye/march/march.h"
#include "draw/eye/quick/map.h"

#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC optimize("no-tree-pre")  // see meet.c
#endif

/* At the texels: slope of the relief to the next ones, and the stroma's thickness. */
struct texels {
	float gx[PART], gy[PART], thick[PART];
};

/* The map's edge repeats. */
SIMD_CLONES static void texels_read(struct texels *restrict x, float *restrict pz, const struct march_tile *t, const struct scene_level *l, float plane)
{
	float per = l->per_mm * SCENE_PAIR_MM;
	int last = l->n - 1, stride = SCENE_PAIR_STRIDE(l->n);
	for (int y = 0; y < TILE_SIDE; y++) {
		int v = t->ty * TILE_SIDE + y, row = v < last ? v : last, next = v + 1 < last ? v + 1 : last, first = t->tx * TILE_SIDE;
		const int *restrict p = l->pairs + (long)row * stride + first, *restrict q = l->pairs + (long)next * stride + first;
		const int *restrict bottom = l->bottom + (long)row * stride + first;
		SIMD_LOOP
		for (int i = 0; i < TILE_SIDE; i++) {
			float a = (float)(int16_t)p[i], b = (float)(p[i] >> 16), c = (float)(int16_t)q[i];
			int k = y * TILE_SIDE + i;
			pz[k] = plane - a * SCENE_PAIR_MM;
			x->gx[k] = (b - a) * per;
			x->gy[k] = (c - a) * per;
			x->thick[k] = (a - 2 * (float)(int16_t)bottom[i]) * SCENE_PAIR_MM;
		}
	}
}

/* Down to the epithelium. */
SIMD_CLONES static void spans(struct iris_batch *restrict r, const struct texels *restrict x, const struct scene_level *l, float plane, float abl)
{
	const int *restrict bottom = l->bottom;
	float per_mm = l->per_mm;
	int size = l->n;
	SIMD_LOOP
	for (int i = 0; i < PART; i++) {
		float rate = r->vz[i] + x->gx[i] * r->vx[i] + x->gy[i] * r->vy[i];  // depth below the relief gained in a mm of the way
		rate = rate > 0.2f ? rate : 0.2f;
		float all = abl + x->thick[i], s = all / rate, most = 3 * all, inv = 1 / r->vz[i], hx, hy;
#pragma GCC unroll 2
		for (int k = 0; k < 2; k++) {
			float z = r->pz[i] + s * r->vz[i] + 2 * quick_height_at(bottom, size, per_mm, r->px[i] + s * r->vx[i], r->py[i] + s * r->vy[i], &hx, &hy);
			s += (abl + plane - z) * inv;
			s = s > 1e-3f ? s < most ? s : most : 1e-3f;
		}
		float a = abl / rate;
		r->span[i] = s;
		r->near[i] = a < s ? a : s;
	}
}

void scene_tile_ground(struct iris_batch *r, const struct march_tile *t, const struct scene *s, const struct scene_level *l)
{
	struct texels x;
	texels_read(&x, r->pz, t, l, (float)s->eye.iris_depth);
	spans(r, &x, l, (float)s->eye.iris_depth, (float)s->optics.abl_thickness);
}
