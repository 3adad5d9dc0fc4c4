/* Colours of tiles that grid.c has found. The factors of light and film are smooth: known at the nodes, incremented from pixel to
 * pixel. Only where the reflection shows an edge is the environment looked up in every pixel. */
#include <math.h>
#include <string.h>

#include "draw/eye/quick/film.h"

#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC optimize("no-tree-pre", "fp-contract=fast")  // see draw/eye/march/meet.c, simd.h
#endif

/* What the tile looks up in every pixel. */
struct maps {
	struct quick_places detail, light, white, sharp, rough;
	float lid[BATCH], mirror[BATCH], roughness[BATCH];
};

SIMD_CLONES static void maps_iris(struct maps *m, const struct quick_nodes *s, const struct quick_look *k)
{
	const struct scene_shade *h = k->shade;
	int n = h->detail->n;
	quick_places_of(&m->detail, s->place[0], s->place[1], h->per_mm, 0.5f * (float)n - 0.5f, n, h->detail->stride, BATCH);
	if (!h->even)
		quick_places_of(&m->light, s->place[0], s->place[1], h->light_per_mm, 0.5f * (float)h->light_n - 0.5f, h->light_n, h->light_stride, BATCH);
}

SIMD_CLONES static void maps_white(struct maps *m, const struct quick_nodes *s, const struct quick_look *k, bool lid)
{
	float u[BATCH], v[BATCH], w = (float)k->scene->white.n, inv = 1 / k->lid_width, lo = 1 - 0.5f * k->lid_width;
	quick_lay(u, s->wu);
	quick_lay(v, s->wv);
	quick_places_of(&m->white, u, v, w, 0.5f * w - 0.5f, k->scene->white.n, k->scene->white.stride, BATCH);
	if (!lid)
		return;
	quick_lay(m->lid, s->rho);
	SIMD_LOOP
	for (int i = 0; i < BATCH; i++)
		m->lid[i] = quick_ramp(lo, inv, m->lid[i]);
}

SIMD_CLONES static void maps_mirror(struct maps *m, const struct quick_nodes *s, const struct envmap *env, bool rough)
{
	float u[BATCH], v[BATCH], w = (float)env->sharp.width, r = (float)env->rough.width;
	quick_lay(u, s->eu);
	quick_lay(v, s->ev);
	quick_lay(m->mirror, s->mirror);
	quick_places_of(&m->sharp, u, v, 0.5f * w, 0.5f * w - 0.5f, env->sharp.width, env->sharp.width, BATCH);
	if (rough) {
		quick_lay(m->roughness, s->rough);
		quick_places_of(&m->rough, u, v, 0.5f * r, 0.5f * r - 0.5f, env->rough.width, env->rough.width, BATCH);
	}
}

/* Nodes' values along the pixel row y of a tile, and what a step to the next row adds. */
struct steps {
	quick_four at[FILM_SIDE], by[FILM_SIDE];
};

SIMD_INLINE void steps_on(struct steps *s, const quick_four node[], int y, int side)
{
	int step = QUICK_TILE / (side - 1);
	const quick_four *a = node + y / step * side, *b = a + side;
	for (int i = 0; i < side; i++) {
		if (y % step == 0) {
			s->by[i] = (1.0f / (float)step) * (b[i] - a[i]);
			s->at[i] = a[i];
		} else {
			s->at[i] += s->by[i];
		}
	}
}

enum { PAINT_IRIS = 1, PAINT_WHITE = 2, PAINT_EVEN = 4, PAINT_EDGE = 8 };

SIMD_INLINE quick_four mirrored(const struct maps *m, const struct envmap *env, int i, bool rough)
{
	quick_four c = quick_look_up(env->sharp.px, env->sharp.width, &m->sharp, i);
	if (rough)
		c += m->roughness[i] * (quick_look_up(env->rough.px, env->rough.width, &m->rough, i) - c);
	c *= m->mirror[i];
	c[3] = 0;
	return c;
}

SIMD_INLINE void paint(float *restrict out, long stride, const struct quick_film *restrict f, const struct maps *restrict m, const struct quick_look *k, int what)
{
	const struct scene_shade *h = k->shade;
	const bool iris = what & PAINT_IRIS, white = what & PAINT_WHITE, even = what & PAINT_EVEN, edge = what & PAINT_EDGE;
	const quick_four none = { 0 };
	struct steps a, b, c;
	for (int y = 0; y < QUICK_TILE; y++) {
		float *restrict row = out + y * stride;
		steps_on(&a, f->mirror, y, FILM_SIDE);
		if (iris)
			steps_on(&b, f->iris, y, NODE_SIDE);
		if (white)
			steps_on(&c, f->white, y, NODE_SIDE);
		quick_four q = none, r = none, dq = none, dr = none;
		for (int x = 0; x < QUICK_TILE; x += FILM_STEP) {
			int i = x / FILM_STEP, j = x / NODE_STEP;
			quick_four p = a.at[i], dp = 0.25f * (a.at[i + 1] - p);
			if (iris && x % NODE_STEP == 0) {
				q = b.at[j];
				dq = 0.125f * (b.at[j + 1] - q);
			}
			if (white && x % NODE_STEP == 0) {
				r = c.at[j];
				dr = 0.125f * (c.at[j + 1] - r);
			}
#pragma GCC unroll 4
			for (int t = 0; t < FILM_STEP; t++, p += dp, q += dq, r += dr) {
				int i = y * QUICK_TILE + x + t;
				quick_four colour = p;
				if (iris) {
					quick_four seen = q * quick_texel(h->detail, &m->detail, i);
					if (!even)
						seen *= quick_look_up(h->light, h->light_stride, &m->light, i);
					colour += white ? (1 - m->lid[i]) * seen : seen;
				}
				if (white) {
					quick_four seen = r * quick_texel(&k->scene->white, &m->white, i);
					colour += iris ? m->lid[i] * seen : seen;
				}
				if (edge)
					colour += mirrored(m, k->light->mirror, i, white);
				memcpy(row + 4 * (x + t), &colour, sizeof colour);
			}
		}
	}
}

#define PAINT(name, what)                                                                                                                             \
	SIMD_CLONES static void name(float *out, long stride, const struct quick_film *f, const struct maps *m, const struct quick_look *k) \
	{                                                                                                                                                 \
		paint(out, stride, f, m, k, what);                                                                                                            \
	}
PAINT(paint_iris, PAINT_IRIS)
PAINT(paint_iris_edge, PAINT_IRIS | PAINT_EDGE)
PAINT(paint_even, PAINT_IRIS | PAINT_EVEN)
PAINT(paint_even_edge, PAINT_IRIS | PAINT_EVEN | PAINT_EDGE)
PAINT(paint_white, PAINT_WHITE)
PAINT(paint_white_edge, PAINT_WHITE | PAINT_EDGE)
PAINT(paint_limbus, PAINT_IRIS | PAINT_WHITE)
PAINT(paint_limbus_edge, PAINT_IRIS | PAINT_WHITE | PAINT_EDGE)
PAINT(paint_limbus_even, PAINT_IRIS | PAINT_WHITE | PAINT_EVEN)
PAINT(paint_limbus_even_edge, PAINT_IRIS | PAINT_WHITE | PAINT_EVEN | PAINT_EDGE)

void quick_tile_colour(float *out, long stride, struct quick_found *found, const struct quick_look *k)
{
	typedef void painter(float *, long, const struct quick_film *, const struct maps *, const struct quick_look *);
	static painter *const with[3][2][2] = {  // iris, white, both; light looked up, even; mirror image even, looked up
		{ { paint_iris, paint_iris_edge }, { paint_even, paint_even_edge } },
		{ { paint_white, paint_white_edge }, { paint_white, paint_white_edge } },
		{ { paint_limbus, paint_limbus_edge }, { paint_limbus_even, paint_limbus_even_edge } },
	};
	struct quick_film film;
	struct maps maps;
	quick_film_make(&film, found, k);
	if (found->seen)
		maps_iris(&maps, &found->nodes, k);
	if (found->white)
		maps_white(&maps, &found->nodes, k, found->seen);
	bool edge = film.step == 1;
	if (edge)
		maps_mirror(&maps, &found->nodes, k->light->mirror, found->white);
	int what = !found->white ? 0 : found->seen ? 2 : 1;
	with[what][k->shade->even][edge](out, stride, &film, &maps, k);
}
