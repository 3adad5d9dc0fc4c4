/* Tiles of scene_quick.h where nothing but the maps varies fast: all of the cornea, or all of the sclera. Rays are followed
 * at every fourth pixel; between them places, directions and Fresnel are linear, to 1e-3 px of what each ray would find
 * (over 4 px the refracted place bends by (4 px)^2 / 8 of 0.014 / mm). */
#include "eye/scene_quick.h"

#include <math.h>
#include <string.h>

#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC optimize("no-tree-pre")  // see scene_meet.c
#endif

typedef float four __attribute__((vector_size(16), aligned(16)));
_Static_assert(GRID_STEP == 4 && GRID_SIDE == QUICK_TILE / GRID_STEP + 1, "a row is four vectors of four");

SIMD_CLONES void quick_lay(float *restrict out, const float node[GRID_NODES])
{
	const four ramp = { 0, 0.25f, 0.5f, 0.75f };
	for (int y = 0; y < QUICK_TILE; y++) {
		const float *a = node + y / GRID_STEP * GRID_ROW, *b = a + GRID_ROW;
		float v = 0.25f * (float)(y % GRID_STEP), r[GRID_ROW];
		SIMD_LOOP
		for (int i = 0; i < GRID_ROW; i++)
			r[i] = a[i] + v * (b[i] - a[i]);
		for (int i = 0; i < GRID_SIDE - 1; i++) {
			four c = r[i] + ramp * (r[i + 1] - r[i]);
			memcpy(out + y * QUICK_TILE + i * GRID_STEP, &c, sizeof c);
		}
	}
}

/* All nodes well inside the limbus, or well outside; and none seen at a grazing angle, where places run away. */
static enum quick_kind kind_of(const struct quick_spots *s, const struct quick_rays *r, const struct quick_look *k)
{
	float inner = fminf((float)LOOK_SEAM_FROM, 1 - 0.5f * k->lid_width), outer = fmaxf(1.08f, 1 + 0.5f * k->lid_width);
	float wide = fabsf(r->ox[GRID_LAST] - r->ox[0]) + fabsf(r->oy[GRID_LAST] - r->oy[0]) + fabsf(r->oz[GRID_LAST] - r->oz[0]);
	int in = 0, out = 0;
	for (int i = 0; i < GRID_NODES; i++) {
		bool faces = s->hit[i] > 0 && -(s->nx[i] * r->dx[i] + s->ny[i] * r->dy[i] + s->nz[i] * r->dz[i]) > 0.3f;
		in += faces && s->rho[i] < inner;
		out += faces && s->rho[i] > outer;
	}
	if (wide * k->limbus[0] > 0.4f)
		return QUICK_MIXED;
	return in == GRID_NODES ? QUICK_CORNEA : out == GRID_NODES ? QUICK_SCLERA : QUICK_MIXED;
}

/* Where rays behind the cornea cross the iris plane, and how far aside they go in a mm of depth. */
SIMD_CLONES static void cross_plane(float (*q)[GRID_NODES], const struct quick_spots *s, const struct quick_look *k)
{
	float plane = (float)k->scene->eye.iris_depth;
	SIMD_LOOP
	for (int i = 0; i < GRID_NODES; i++) {
		float fx = s->fx[i], fy = s->fy[i], vx = s->vx[i], vy = s->vy[i], c = s->vz[i] > 0.1f ? s->vz[i] : 0.1f;
		float a = (vx + k->slip[0][0] * vx + k->slip[0][1] * vy) / c, b = (vy + k->slip[1][0] * vx + k->slip[1][1] * vy) / c, t = plane - s->fz[i];
		q[GRID_U][i] = fx + k->slip[0][0] * fx + k->slip[0][1] * fy + k->slip[0][2] + t * a;
		q[GRID_V][i] = fy + k->slip[1][0] * fx + k->slip[1][1] * fy + k->slip[1][2] + t * b;
		q[GRID_ASIDE][i] = a;
		q[GRID_ACROSS][i] = b;
	}
}

/* Newton's steps for the height at which a ray that crosses the iris plane at u, v meets the relief. */
SIMD_INLINE float meet(float h, float u, float v, float aside, float across, const struct quick_look *k, int steps)
{
	float per_mm = k->level->per_mm, most = k->scene->height_max, least = k->scene->height_min;
#pragma GCC unroll 3
	for (int j = 0; j < steps; j++) {
		float gx, gy, off = quick_height_at(k->level->pairs, k->level->n, per_mm, u - h * aside, v - h * across, &gx, &gy) - h;
		float slope = 1 + gx * aside + gy * across;
		h += off / (slope > 0.3f ? slope : 0.3f);
		h = h > least ? h < most ? h : most : least;
	}
	return h;
}

SIMD_CLONES static void meet_nodes(float (*q)[GRID_NODES], const struct quick_look *look)
{
	const struct quick_look k = *look;
	SIMD_LOOP
	for (int i = 0; i < GRID_NODES; i++)
		q[GRID_HEIGHT][i] = meet(0, q[GRID_U][i], q[GRID_V][i], q[GRID_ASIDE][i], q[GRID_ACROSS][i], &k, 3);
}

/* u, v: on the plane, then on the relief. From the nodes' heights one more step is enough. */
SIMD_CLONES static void meet_pixels(float *restrict u, float *restrict v, const float *restrict aside, const float *restrict across,
                                    const float *restrict start, const struct quick_look *look)
{
	const struct quick_look k = *look;
	SIMD_LOOP
	for (int i = 0; i < BATCH; i++) {
		float h = meet(start[i], u[i], v[i], aside[i], across[i], &k, 1);
		u[i] -= h * aside[i];
		v[i] -= h * across[i];
	}
}

bool quick_grid(struct quick_found *f, const struct quick_rays *nodes, const struct quick_look *k)
{
	float q[GRID_CHANNELS][GRID_NODES], back[BATCH], aside[2][BATCH], height[BATCH];
	struct quick_spots *s = &f->spots;
	quick_outside(s, nodes, k);
	f->kind = kind_of(s, nodes, k);
	if (f->kind == QUICK_MIXED)
		return false;
	bool cornea = f->kind == QUICK_CORNEA;
	f->hit = BATCH;
	f->seen = cornea ? BATCH : 0;
	f->white = BATCH - f->seen;
	quick_bend(f, GRID_NODES, k);
	quick_reflect(q[GRID_RX], q[GRID_RY], q[GRID_RZ], f, nodes, k);
	memcpy(q[GRID_MIRROR], s->mirror, sizeof q[GRID_MIRROR]);
	if (cornea) {
		cross_plane(q, s, k);
		meet_nodes(q, k);
		quick_lay(height, q[GRID_HEIGHT]);
		quick_lay(aside[0], q[GRID_ASIDE]);
		quick_lay(aside[1], q[GRID_ACROSS]);
	} else {
		memcpy(q[GRID_U], s->su, sizeof q[GRID_U]);
		memcpy(q[GRID_V], s->sv, sizeof q[GRID_V]);
		memcpy(q[GRID_ROUGH], s->rough, sizeof q[GRID_ROUGH]);
		quick_lay(s->rough, q[GRID_ROUGH]);
	}
	float *u = cornea ? s->iu : s->su, *v = cornea ? s->iv : s->sv;
	quick_lay(u, q[GRID_U]);
	quick_lay(v, q[GRID_V]);
	if (cornea)
		meet_pixels(u, v, aside[0], aside[1], height, k);
	quick_lay(s->mirror, q[GRID_MIRROR]);
	quick_lay(s->eu, q[GRID_RX]);
	quick_lay(s->ev, q[GRID_RY]);
	quick_lay(back, q[GRID_RZ]);
	quick_unfold(BATCH, s->eu, s->ev, back);
	return true;
}
