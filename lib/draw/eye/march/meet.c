/* Where rays of sight meet the relief, and their length in each layer below it (iris paper, section 5.3). */
#include "draw/eye/march/march.h"

#include <math.h>

#if defined(__GNUC__) && !defined(__clang__)
// This pass turns the bounds of relief_at into branches, and keeps loops over it from becoming vector code.
#pragma GCC optimize("no-tree-pre", "fp-contract=fast")
#endif

/* A bracket of the crossing along each ray: at length a the ray is above the relief, at b below it; fa, fb: depth below it, mm. */
struct bracket {
	float a[BATCH], fa[BATCH], b[BATCH], fb[BATCH], found[BATCH], step[BATCH];
};

struct ground ground_of(const struct scene *s, const struct scene_level *level)
{
	float z = (float)s->eye.iris_depth, slack = 1e-4f;  // mm: the search never starts on the very highest point
	return (struct ground){ level->relief, level->pairs, level->n, level->per_mm, z, z - s->height_max - slack,
	                        z - s->height_min + slack, (float)s->optics.abl_thickness };
}

SIMD_CLONES
static void search_step(int n, struct bracket *m, const struct iris_batch *r, const struct ground *g, bool last)
{
	const float *restrict fx = r->fx, *restrict fy = r->fy, *restrict fz = r->fz, *restrict relief = g->relief;
	const float *restrict vx = r->vx, *restrict vy = r->vy, *restrict vz = r->vz, *restrict step = m->step;
	float *restrict a = m->a, *restrict fa = m->fa, *restrict b = m->b, *restrict fb = m->fb, *restrict found = m->found;
	float per_mm = g->per_mm, z_plane = g->z_plane;
	int size = g->size;
	SIMD_LOOP
	for (int i = 0; i < n; i++) {
		float t = a[i] + step[i], gx, gy, x = fx[i] + t * vx[i], y = fy[i] + t * vy[i];
		float f = fz[i] + t * vz[i] - z_plane + relief_at(relief, size, per_mm, x, y, &gx, &gy);
		float old = found[i], now = old > 0 ? 1.0f : f >= 0 || last ? 1.0f : 0.0f;
		float b0 = b[i], fb0 = fb[i], a0 = a[i], fa0 = fa[i];
		b[i] = old > 0 ? b0 : t;
		fb[i] = old > 0 ? fb0 : f;
		a[i] = now > 0 ? a0 : t;
		fa[i] = now > 0 ? fa0 : f;
		found[i] = now;
	}
}

/* Regula falsi: the relief is nearly straight inside the bracket. */
SIMD_CLONES
static void falsi_step(int n, struct bracket *m, const struct iris_batch *r, const struct ground *g)
{
	const float *restrict fx = r->fx, *restrict fy = r->fy, *restrict fz = r->fz, *restrict relief = g->relief;
	const float *restrict vx = r->vx, *restrict vy = r->vy, *restrict vz = r->vz;
	float *restrict a = m->a, *restrict fa = m->fa, *restrict b = m->b, *restrict fb = m->fb;
	float per_mm = g->per_mm, z_plane = g->z_plane;
	int size = g->size;
	SIMD_LOOP
	for (int i = 0; i < n; i++) {
		float a0 = a[i], fa0 = fa[i], b0 = b[i], fb0 = fb[i], d = fb0 - fa0 + 1e-12f;
		float t = a0 - fa0 * (b0 - a0) / d, gx, gy, x = fx[i] + t * vx[i], y = fy[i] + t * vy[i];
		float f = fz[i] + t * vz[i] - z_plane + relief_at(relief, size, per_mm, x, y, &gx, &gy);
		b[i] = f >= 0 ? t : b0;
		fb[i] = f >= 0 ? f : fb0;
		a[i] = f >= 0 ? a0 : t;
		fa[i] = f >= 0 ? fa0 : f;
	}
}

void scene_meet(struct iris_batch *r, const struct scene *s, const struct scene_level *level)
{
	struct bracket m;
	struct ground g = ground_of(s, level);
	for (int i = 0; i < r->n; i++) {
		float start = (g.z_high - r->fz[i]) / r->vz[i], end = (g.z_low - r->fz[i]) / r->vz[i];
		m.a[i] = start;
		m.fa[i] = -1e-6f;
		m.step[i] = (end - start) / (float)s->conf.search;
		m.found[i] = 0;
	}
	for (int k = 1; k <= s->conf.search; k++)
		search_step(r->n, &m, r, &g, k == s->conf.search);
	for (int k = 0; k < 2; k++)
		falsi_step(r->n, &m, r, &g);
	for (int i = 0; i < r->n; i++) {
		float d = m.fb[i] - m.fa[i], t = d > 1e-12f ? m.a[i] - m.fa[i] * (m.b[i] - m.a[i]) / d : m.b[i];
		r->px[i] = r->fx[i] + t * r->vx[i];
		r->py[i] = r->fy[i] + t * r->vy[i];
		r->pz[i] = r->fz[i] + t * r->vz[i];
	}
}

/* The ray's length in each layer, down to the epithelium, by two fixed-point steps. */
SIMD_CLONES
void scene_spans(struct iris_batch *r, const struct ground *g)
{
	const float *restrict px = r->px, *restrict py = r->py, *restrict pz = r->pz, *restrict relief = g->relief;
	const float *restrict vx = r->vx, *restrict vy = r->vy, *restrict vz = r->vz;
	float *restrict near = r->near, *restrict span = r->span;
	float per_mm = g->per_mm, z_plane = g->z_plane, abl = g->abl;
	int size = g->size;
	SIMD_LOOP
	for (int i = 0; i < r->n; i++) {
		float gx, gy, hx, hy;
		relief_at(relief, size, per_mm, px[i], py[i], &gx, &gy);
		float rate = vz[i] + gx * vx[i] + gy * vy[i];  // depth below the relief gained in a mm of the way
		rate = rate > 0.2f ? rate : 0.2f;
		float thick = channel_at(relief, size, per_mm, px[i], py[i], 2, 1);
		float s = (abl + thick) / rate, most = 3 * (abl + thick);
		for (int k = 0; k < 2; k++) {
			float x = px[i] + s * vx[i], y = py[i] + s * vy[i];
			float depth = pz[i] + s * vz[i] - z_plane + relief_at(relief, size, per_mm, x, y, &hx, &hy);
			s += (abl + channel_at(relief, size, per_mm, x, y, 2, 1) - depth) / vz[i];
			s = s > 1e-3f ? s < most ? s : most : 1e-3f;
		}
		span[i] = s;
		float a = abl / rate;
		near[i] = a < s ? a : s;
	}
}

