/* Rays at the nodes of the tiles of grid.c, a strip of tiles at a time: neighbours share their nodes, and the vectors are full. */
#include "draw/eye/quick/quick.h"

#include <math.h>

#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC optimize("no-tree-pre", "fp-contract=fast")  // see draw/eye/march/meet.c, simd.h
#endif

static void nodes_make(struct quick_rays *r, float x, float y, int across, quick_make *make, const void *ctx)
{
	float u[BATCH], v[BATCH];
	r->n = NODE_SIDE * across;
	for (int k = 0; k < NODE_SIDE; k++)
		for (int i = 0; i < across; i++) {
			u[k * across + i] = x + (float)(NODE_STEP * i);
			v[k * across + i] = y + (float)(NODE_STEP * k);
		}
	make(r, u, v, ctx);
}

/* Sets the flags of the nodes: the kinds of tile that each allows. */
SIMD_CLONES static void judge(unsigned char *restrict is, const struct quick_spots *restrict s, const struct quick_rays *restrict r, const struct quick_look *k)
{
	float inner = 1 - 0.5f * k->lid_width, outer = 1 + 0.5f * k->lid_width;
	SIMD_LOOP
	for (int i = 0; i < r->n; i++) {
		float cosine = -(s->nx[i] * r->dx[i] + s->ny[i] * r->dy[i] + s->nz[i] * r->dz[i]);
		int faces = (s->hit[i] > 0) & (cosine > 0.3f);
		// The ray enters the cornea, or would enter the conic continued beyond its rim.
		int through = (s->vz[i] > 0.3f) & (s->fz[i] > -0.1f) & (s->fz[i] < 5);
		int in = faces & (s->rho[i] < inner), out = faces & (s->rho[i] > outer);
		is[i] = (unsigned char)((faces ? NODE_FACES : 0) | (in ? NODE_IN : 0) | (out ? NODE_OUT : 0) | (through ? NODE_THROUGH : 0) | (quick_leans(s->vx[i], s->vy[i], s->vz[i]) ? 0 : NODE_STRAIGHT));
	}
}

/* Where rays cross the iris plane and meet the relief, and how they lean. Pixels start from values interpolated between nodes: the relief as
 * coarse as these is as good a start as the relief at them, and stays in the cache. */
SIMD_CLONES static void meet_nodes(float (*restrict q)[BATCH], int n, const struct quick_spots *restrict s, const struct quick_look *look)
{
	const struct quick_look k = *look;
	const struct scene_level level = *k.smooth;
	float plane = (float)k.scene->eye.iris_depth, least = k.scene->height_min, most = k.scene->height_max;
	SIMD_LOOP
	for (int i = 0; i < n; i++) {
		float fx = s->fx[i], fy = s->fy[i], vx = s->vx[i], vy = s->vy[i], c = s->vz[i] > 0.1f ? s->vz[i] : 0.1f;
		float a = (vx + k.slip[0][0] * vx + k.slip[0][1] * vy) / c, b = (vy + k.slip[1][0] * vx + k.slip[1][1] * vy) / c, t = plane - s->fz[i];
		float u = fx + k.slip[0][0] * fx + k.slip[0][1] * fy + k.slip[0][2] + t * a;
		float v = fy + k.slip[1][0] * fx + k.slip[1][1] * fy + k.slip[1][2] + t * b;
		q[NODE_U][i] = u;
		q[NODE_V][i] = v;
		q[NODE_ASIDE][i] = a;
		q[NODE_ACROSS][i] = b;
		q[NODE_HEIGHT][i] = quick_meet(0, u, v, a, b, &level, least, most, 3);
	}
}

void quick_strip(struct quick_strip *strip, float x, float y, int tiles, quick_make *make, const void *ctx, const struct quick_look *k)
{
	struct quick_found *f = &strip->found;
	struct quick_spots *s = &f->spots;
	struct quick_rays r;
	float back[BATCH];
	int some = 0, all = NODE_IN, last;
	strip->across = tiles * (NODE_SIDE - 1) + 1;
	last = (NODE_SIDE - 1) * (strip->across + 1);
	nodes_make(&r, x, y, strip->across, make, ctx);
	strip->far = fabsf(r.ox[last] - r.ox[0]) + fabsf(r.oy[last] - r.oy[0]) + fabsf(r.oz[last] - r.oz[0]);
	quick_outside(s, &r, k);
	judge(strip->is, s, &r, k);
	for (int i = 0; i < r.n; i++) {
		some |= strip->is[i];
		all &= strip->is[i];
	}
	if (!(some & NODE_FACES))
		return;
	f->white = !all;
	quick_bend(f, r.n, k);
	quick_reflect(s->eu, s->ev, back, f, &r, k);
	quick_unfold(r.n, s->eu, s->ev, back);
	if (some & (NODE_IN | NODE_THROUGH))
		meet_nodes(strip->between, r.n, s, k);
}
