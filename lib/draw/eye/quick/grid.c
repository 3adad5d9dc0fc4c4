/* Tiles of quick.h in which only the maps vary fast. Rays are followed at the nodes; between them places, directions and Fresnel
 * reflectance are interpolated linearly, to 2e-3 px of what each ray would find (over 8 px the refracted place bends by
 * (8 px)^2 / 8 of 0.014 / mm). */
#include "base/mem.h"
#include "draw/eye/quick/quick.h"

#include <math.h>
#include <string.h>

#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC optimize("no-tree-pre", "fp-contract=fast")  // see draw/eye/march/meet.c, simd.h
#endif

_Static_assert(NODE_STEP == 8 && NODE_SIDE == QUICK_TILE / NODE_STEP + 1, "a row is two vectors of eight");

SIMD_INLINE void rows_lay(float (*restrict rows)[QUICK_TILE], const float *restrict node)
{
	for (int k = 0; k < NODE_SIDE; k++) {
		float a = node[k * NODE_SIDE], b = node[k * NODE_SIDE + 1], c = node[k * NODE_SIDE + 2];
		SIMD_LOOP
		for (int i = 0; i < NODE_STEP; i++) {
			float u = (float)i / NODE_STEP;
			rows[k][i] = a + u * (b - a);
			rows[k][NODE_STEP + i] = b + u * (c - b);
		}
	}
}

SIMD_CLONES void quick_lay(float *restrict out, const float node[NODE_LANES])
{
	float rows[NODE_SIDE][QUICK_TILE];
	rows_lay(rows, node);
	for (int y = 0; y < QUICK_TILE; y++) {
		float v = (float)(y % NODE_STEP) / NODE_STEP;
		const float *a = rows[y / NODE_STEP], *b = a + QUICK_TILE;
		SIMD_LOOP
		for (int i = 0; i < QUICK_TILE; i++)
			out[y * QUICK_TILE + i] = a[i] + v * (b[i] - a[i]);
	}
}

/* The kind of a tile: all nodes inside the limbus, all outside, or about it. Mixed, if one is seen at a grazing angle, where places
 * change too fast, or so obliquely that relief hides relief. */
static enum quick_kind kind_of(const struct quick_strip *strip, int first, const struct quick_look *k)
{
	unsigned char all = 0xff;
	for (int y = 0; y < NODE_SIDE; y++)
		for (int x = 0; x < NODE_SIDE; x++)
			all &= strip->is[first + y * strip->across + x];
	if (strip->far * k->limbus[0] > 0.1f || !(all & NODE_FACES))
		return QUICK_MIXED;
	if (all & NODE_OUT)
		return QUICK_SCLERA;
	return !(all & NODE_STRAIGHT) ? QUICK_MIXED : all & NODE_IN ? QUICK_CORNEA : all & NODE_THROUGH ? QUICK_LIMBUS : QUICK_MIXED;
}

/* One Newton step from the interpolated heights is enough. */
SIMD_CLONES static void meet_pixels(float *restrict u, float *restrict v, const float (*restrict q)[NODE_LANES], const struct quick_look *look)
{
	const struct scene_level level = *look->level;
	float least = look->scene->height_min, most = look->scene->height_max;
	float rows[NODE_CHANNELS][NODE_SIDE][QUICK_TILE];
	for (int c = 0; c < NODE_CHANNELS; c++)
		rows_lay(rows[c], q[c]);
	for (int y = 0; y < QUICK_TILE; y++) {
		int a = y / NODE_STEP, b = a + 1;
		float w = (float)(y % NODE_STEP) / NODE_STEP, *restrict out_u = u + y * QUICK_TILE, *restrict out_v = v + y * QUICK_TILE;
		SIMD_LOOP
		for (int i = 0; i < QUICK_TILE; i++) {
			float p[NODE_CHANNELS];
#pragma GCC unroll 5
			for (int c = 0; c < NODE_CHANNELS; c++)
				p[c] = rows[c][a][i] + w * (rows[c][b][i] - rows[c][a][i]);
			float h = quick_meet(p[NODE_HEIGHT], p[NODE_U], p[NODE_V], p[NODE_ASIDE], p[NODE_ACROSS], &level, least, most, 1);
			out_u[i] = p[NODE_U] - h * p[NODE_ASIDE];
			out_v[i] = p[NODE_V] - h * p[NODE_ACROSS];
		}
	}
}

/* Places on the environment's octahedron jump where its far corners meet. */
static bool jumps(const float *u, const float *v, int n)
{
	float low[2] = { 1, 1 }, high[2] = { -1, -1 };
	for (int i = 0; i < n; i++) {
		low[0] = u[i] < low[0] ? u[i] : low[0];
		low[1] = v[i] < low[1] ? v[i] : low[1];
		high[0] = u[i] > high[0] ? u[i] : high[0];
		high[1] = v[i] > high[1] ? v[i] : high[1];
	}
	return high[0] - low[0] > 0.5f || high[1] - low[1] > 0.5f;
}

void quick_grid_pixels(struct quick_found *f, const struct quick_look *k)
{
	if (f->kind != QUICK_MIXED && f->seen)
		meet_pixels(f->nodes.place[0], f->nodes.place[1], (const float(*)[NODE_LANES])f->between, k);
}

/* Texels of a map of n x n, `per` in a unit of the nodes' places, at three columns of a tile: its first, its middle, the next tile's
 * first. */
enum { ROWS = QUICK_TILE + 1 };

SIMD_CLONES static void columns(int *restrict x, int *restrict y, const float *u, const float *v, float per, int n)
{
	float off = 0.5f * (float)n - 0.5f, top = (float)n - 1;
	for (int i = 0; i < NODE_SIDE; i++) {
		float u0 = u[i], u1 = u[NODE_SIDE + i], u2 = u[2 * NODE_SIDE + i], v0 = v[i], v1 = v[NODE_SIDE + i], v2 = v[2 * NODE_SIDE + i];
		SIMD_LOOP
		for (int k = 0; k < ROWS; k++) {
			float w = (float)k / NODE_STEP, s = w > 1 ? w - 1 : 0;
			w = w < 1 ? w : 1;
			x[i * ROWS + k] = (int)quick_clamp((u0 + w * (u1 - u0) + s * (u2 - u1)) * per + off, 0, top);
			y[i * ROWS + k] = (int)quick_clamp((v0 + w * (v1 - v0) + s * (v2 - v1)) * per + off, 0, top);
		}
	}
}

/* The environment where the nodes mirror it. */
SIMD_CLONES static void ask_mirror(const struct quick_nodes *n, const struct image *map)
{
	struct quick_places p;
	float w = (float)map->width;
	quick_places_of(&p, n->eu, n->ev, 0.5f * w, 0.5f * w - 0.5f, map->width, map->width, NODES_IN_TILE);
	for (int i = 0; i < NODES_IN_TILE; i++) {
		__builtin_prefetch(map->px + p.at[i]);
		__builtin_prefetch(map->px + p.at[i] + 4L * map->width);
	}
}

void quick_ask(const struct quick_found *f, const struct quick_look *k)
{
	const struct scene_shade *h = k->shade;
	const struct scene_texels *t = h->detail, *w = &k->scene->white;
	const struct quick_nodes *n = &f->nodes;
	int x[NODE_SIDE * ROWS], y[NODE_SIDE * ROWS];
	if (f->kind == QUICK_MIXED)
		return;
	if (k->light->mirror)
		ask_mirror(n, &k->light->mirror->sharp);
	if (f->seen) {
		columns(x, y, n->iu, n->iv, h->per_mm, t->n);
		for (int i = 0; i < NODE_SIDE * ROWS; i++) {
			__builtin_prefetch(t->px + 4 * (y[i] * (long)t->stride + x[i]));
			__builtin_prefetch(k->level->pairs + y[i] * (long)SCENE_PAIR_STRIDE(t->n) + x[i]);
		}
	}
	if (f->seen && !h->even) {
		columns(x, y, n->iu, n->iv, h->light_per_mm, h->light_n);
		for (int i = 0; i < NODE_SIDE * ROWS; i += 2)
			__builtin_prefetch(h->light + 4 * (y[i] * (long)h->light_stride + x[i]));
	}
	if (f->white) {
		columns(x, y, n->wu, n->wv, (float)w->n, w->n);
		for (int i = 0; i < NODE_SIDE * ROWS; i += 4)
			__builtin_prefetch(w->px + 4 * (y[i] * (long)w->stride + x[i]));
	}
}

/* A tile's nodes of the strip's; nothing in the lanes behind them. */
SIMD_INLINE void nodes_take(float *restrict out, const float *restrict in, int across)
{
	_Static_assert(NODE_SIDE == 3 && NODE_LANES == 16, "each row's fourth lane is the next row's first");
	for (int y = 0; y < NODE_SIDE; y++) {
		quick_four row = quick_read(in + y * across);
		memcpy(out + y * NODE_SIDE, &row, sizeof row);
	}
	memset(out + NODES_IN_TILE, 0, (NODE_LANES - NODES_IN_TILE) * sizeof *out);
}

SIMD_INLINE void iris_lay(struct quick_found *f)
{
	const float(*q)[NODE_LANES] = (const float(*)[NODE_LANES])f->between;
	SIMD_LOOP
	for (int i = 0; i < NODE_LANES; i++) {
		f->nodes.iu[i] = q[NODE_U][i] - q[NODE_HEIGHT][i] * q[NODE_ASIDE][i];
		f->nodes.iv[i] = q[NODE_V][i] - q[NODE_HEIGHT][i] * q[NODE_ACROSS][i];
	}
}

SIMD_CLONES static void tile_take(struct quick_found *f, const struct quick_strip *strip, int first)
{
	const struct quick_spots *s = &strip->found.spots;
	struct quick_nodes *n = &f->nodes;
	float *const to[] = { n->nx, n->ny, n->nz, n->rho, n->mirror, n->rough, n->eu, n->ev, n->wu, n->wv };
	const float *const from[] = { s->nx, s->ny, s->nz, s->rho, s->mirror, s->rough, s->eu, s->ev, s->su, s->sv };
	for (int k = 0; k < COUNT(to); k++)
		nodes_take(to[k], from[k] + first, strip->across);
	if (!f->seen)
		return;
	for (int k = 0; k < NODE_CHANNELS; k++)
		nodes_take(f->between[k], strip->between[k] + first, strip->across);
	iris_lay(f);
}

bool quick_grid(struct quick_found *f, const struct quick_strip *strip, int tile, const struct quick_look *k)
{
	int first = tile * (NODE_SIDE - 1);
	f->kind = kind_of(strip, first, k);
	if (f->kind == QUICK_MIXED)
		return false;
	f->hit = BATCH;
	f->seen = f->kind == QUICK_SCLERA ? 0 : BATCH;
	f->white = f->kind == QUICK_CORNEA ? 0 : BATCH;
	tile_take(f, strip, first);
	if (jumps(f->nodes.eu, f->nodes.ev, NODES_IN_TILE))
		return false;
	return true;
}
