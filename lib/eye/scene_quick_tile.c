/* Colours of tiles that scene_quick_grid.c has found. What light and film make of the maps' colours is smooth: it is known at
 * the nodes and added up from pixel to pixel; only where the mirror shows an edge is the environment looked up in every one. */
#include <math.h>
#include <string.h>

#include "eye/scene_quick.h"

#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC optimize("no-tree-pre", "fp-contract=fast")  // see scene_meet.c, simd.h
#endif

/* The mirror image is looked up at every fourth pixel, five by five. */
enum { FILM_STEP = 4, FILM_SIDE = 5, FILM_LANES = 32 };

/* At the nodes: what the iris' colour, and the white's, is multiplied by; and what is mirrored, with the cover. */
struct film {
	quick_four iris[NODE_LANES], white[NODE_LANES], mirror[FILM_SIDE * FILM_SIDE];
	bool edge;  // the mirror image has one, and is not in it
};

/* What the tile looks up in every pixel. */
struct maps {
	struct quick_places detail, light, white, sharp, rough;
	float lid[BATCH], mirror[BATCH], roughness[BATCH];
};

/* Three by three nodes become five by five. */
SIMD_INLINE void film_refine(float *restrict out, const float *restrict node)
{
	float row[NODE_SIDE][8];
	for (int y = 0; y < NODE_SIDE; y++) {
		const float *q = node + y * NODE_SIDE;
		const float wide[8] = { q[0], 0.5f * (q[0] + q[1]), q[1], 0.5f * (q[1] + q[2]), q[2] };
		memcpy(row[y], wide, sizeof wide);
	}
	for (int y = 0; y < FILM_SIDE; y++)
		for (int x = 0; x < FILM_SIDE; x++)
			out[y * FILM_SIDE + x] = 0.5f * (row[y / 2][x] + row[(y + 1) / 2][x]);
}

/* Places of the environment's pixels that the tile sees. */
SIMD_CLONES static void film_mirror(struct film *f, const struct quick_nodes *s, const struct envmap *env, bool rough)
{
	struct quick_places p, q;
	float w = (float)env->sharp.width, m = (float)env->rough.width, u[FILM_LANES], v[FILM_LANES], mirror[FILM_LANES], roughness[FILM_LANES];
	film_refine(u, s->eu);
	film_refine(v, s->ev);
	film_refine(mirror, s->mirror);
	quick_places_of(&p, u, v, 0.5f * w, 0.5f * w - 0.5f, env->sharp.width, env->sharp.width, FILM_SIDE * FILM_SIDE);
	if (rough) {
		film_refine(roughness, s->rough);
		quick_places_of(&q, u, v, 0.5f * m, 0.5f * m - 0.5f, env->rough.width, env->rough.width, FILM_SIDE * FILM_SIDE);
	}
	for (int i = 0; i < FILM_SIDE * FILM_SIDE; i++) {
		quick_four c = quick_look_up(env->sharp.px, env->sharp.width, &p, i);
		if (rough)
			c += roughness[i] * (quick_look_up(env->rough.px, env->rough.width, &q, i) - c);
		c *= mirror[i];
		c[3] = 1;
		f->mirror[i] = c;
	}
}

struct span {
	float low, high, step;  // step: the longest between neighbours of the five by five
};

SIMD_INLINE float most_of(float a, float b)
{
	return a > b ? a : b;
}

static struct span span_of(const float *u)
{
	struct span s = { u[0], u[0], 0 };
	for (int i = 1; i < NODES_IN_TILE; i++) {
		s.low = u[i] < s.low ? u[i] : s.low;
		s.high = most_of(s.high, u[i]);
	}
	for (int i = 0; i < NODE_SIDE; i++) {
		const float *row = u + i * NODE_SIDE, *column = u + i;
		s.step = most_of(s.step, most_of(fabsf(row[1] - row[0]), fabsf(row[2] - row[1])));
		s.step = most_of(s.step, most_of(fabsf(column[NODE_SIDE] - column[0]), fabsf(column[2 * NODE_SIDE] - column[NODE_SIDE])));
	}
	s.step *= (float)FILM_STEP / NODE_STEP;
	return s;
}

/* Straight lines between nodes miss a mirror image that bends by b a pixel^2 of its by step^2 b / 8: less than an eighth of a
 * hundredth of white? */
static bool film_even(const struct quick_nodes *s, const struct envmap *env)
{
	const float least = 0.01f;
	enum { MOST = 6 };
	float half = 0.5f * (float)env->sharp.width, mirror = 0, bend = 0;
	struct span u = span_of(s->eu), v = span_of(s->ev);
	float step = half * (u.step > v.step ? u.step : v.step);
	int top = env->bend.width - 1, x0 = (int)((u.low + 1) * half) / ENVMAP_BLOCK, x1 = (int)((u.high + 1) * half) / ENVMAP_BLOCK;
	int y0 = (int)((v.low + 1) * half) / ENVMAP_BLOCK, y1 = (int)((v.high + 1) * half) / ENVMAP_BLOCK;
	if (x1 - x0 > MOST || y1 - y0 > MOST)
		return false;
	for (int i = 0; i < NODES_IN_TILE; i++)
		mirror = s->mirror[i] > mirror ? s->mirror[i] : mirror;
	for (int y = y0; y <= y1 && y <= top; y++)
		for (int x = x0; x <= x1 && x <= top; x++) {
			float b = *image_at(&env->bend, x, y);
			bend = b > bend ? b : bend;
		}
	return mirror * bend * (step * step > 1 ? step * step : 1) < 3 * least;
}

/* Light on the iris at the nodes, where it is smooth. */
SIMD_CLONES static void film_iris(struct film *f, const struct quick_found *found, const struct quick_look *k)
{
	const struct scene_shade *h = k->shade;
	struct quick_places p;
	quick_places_of(&p, found->nodes.iu, found->nodes.iv, h->light_per_mm, 0.5f * (float)h->light_n - 0.5f, h->light_n, h->light_stride, NODES_IN_TILE);
	for (int i = 0; i < NODES_IN_TILE; i++) {
		float through = h->detail->step * (1 - found->nodes.mirror[i]);
		quick_four c = { through, through, through, 0 };
		f->iris[i] = h->even ? c * quick_look_up(h->light, h->light_stride, &p, i) : c;
	}
}

static void film_white(struct film *f, const struct quick_nodes *s, const struct quick_look *k)
{
	float sky[3][BATCH];
	quick_sclera(sky, NODE_LANES, s->nx, s->ny, s->nz, s->rho, k);
	for (int i = 0; i < NODES_IN_TILE; i++) {
		float through = k->scene->white.step * (1 - s->mirror[i]);
		f->white[i] = (quick_four){ through * sky[0][i], through * sky[1][i], through * sky[2][i], 0 };
	}
}

static void film_make(struct film *f, struct quick_found *found, const struct quick_look *k)
{
	const struct envmap *env = k->light->mirror;
	f->edge = env && !film_even(&found->nodes, env);
	if (env && !f->edge)
		film_mirror(f, &found->nodes, env, found->white);
	else
		for (int i = 0; i < FILM_SIDE * FILM_SIDE; i++)
			f->mirror[i] = (quick_four){ 0, 0, 0, 1 };
	if (found->seen)
		film_iris(f, found, k);
	if (found->white)
		film_white(f, &found->nodes, k);
}

SIMD_CLONES static void maps_iris(struct maps *m, const struct quick_nodes *s, const struct quick_look *k)
{
	const struct scene_shade *h = k->shade;
	int n = h->detail->n;
	quick_places_of(&m->detail, s->first[0], s->first[1], h->per_mm, 0.5f * (float)n - 0.5f, n, h->detail->stride, BATCH);
	if (!h->even)
		quick_places_of(&m->light, s->first[0], s->first[1], h->light_per_mm, 0.5f * (float)h->light_n - 0.5f, h->light_n, h->light_stride, BATCH);
}

SIMD_CLONES static void maps_white(struct maps *m, const struct quick_nodes *s, const struct quick_look *k, bool lid)
{
	float w = (float)k->scene->white.n, inv = 1 / k->lid_width, lo = 1 - 0.5f * k->lid_width;
	const float(*at)[BATCH] = lid ? s->second : s->first;
	quick_places_of(&m->white, at[0], at[1], w, 0.5f * w - 0.5f, k->scene->white.n, k->scene->white.stride, BATCH);
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

SIMD_INLINE void paint(float *restrict out, long stride, const struct film *restrict f, const struct maps *restrict m, const struct quick_look *k, int what)
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
	SIMD_CLONES static void name(float *out, long stride, const struct film *f, const struct maps *m, const struct quick_look *k) \
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
	typedef void painter(float *, long, const struct film *, const struct maps *, const struct quick_look *);
	static painter *const with[3][2][2] = {  // iris, white, both; light looked up, even; mirror image even, looked up
		{ { paint_iris, paint_iris_edge }, { paint_even, paint_even_edge } },
		{ { paint_white, paint_white_edge }, { paint_white, paint_white_edge } },
		{ { paint_limbus, paint_limbus_edge }, { paint_limbus_even, paint_limbus_even_edge } },
	};
	struct film film;
	struct maps maps;
	film_make(&film, found, k);
	if (found->seen)
		maps_iris(&maps, &found->nodes, k);
	if (found->white)
		maps_white(&maps, &found->nodes, k, found->seen);
	if (film.edge)
		maps_mirror(&maps, &found->nodes, k->light->mirror, found->white);
	int what = !found->white ? 0 : found->seen ? 2 : 1;
	with[what][k->shade->even][film.edge](out, stride, &film, &maps, k);
}
