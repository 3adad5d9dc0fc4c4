/* Light and film on a tile are smooth: computed at its nodes. So is the reflection where it shows no edge. */
#include "draw/eye/quick/film.h"

#include <math.h>
#include <string.h>

#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC optimize("no-tree-pre", "fp-contract=fast")  // see draw/eye/march/meet.c, simd.h
#endif

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

/* What is mirrored at n places of the environment. */
SIMD_INLINE void mirror_at(quick_four *restrict out, int n, const float *u, const float *v, const float *mirror, const float *roughness, const struct envmap *env, bool rough)
{
	struct quick_places p, q;
	float w = (float)env->sharp.width, m = (float)env->rough.width;
	quick_places_of(&p, u, v, 0.5f * w, 0.5f * w - 0.5f, env->sharp.width, env->sharp.width, n);
	if (rough)
		quick_places_of(&q, u, v, 0.5f * m, 0.5f * m - 0.5f, env->rough.width, env->rough.width, n);
	for (int i = 0; i < n; i++) {
		quick_four c = quick_look_up(env->sharp.px, env->sharp.width, &p, i);
		if (rough)
			c += roughness[i] * (quick_look_up(env->rough.px, env->rough.width, &q, i) - c);
		c *= mirror[i];
		c[3] = 1;
		out[i] = c;
	}
}

SIMD_CLONES static void film_mirror(struct quick_film *f, const struct quick_nodes *s, const struct envmap *env, bool rough)
{
	float u[FILM_LANES], v[FILM_LANES], mirror[FILM_LANES], roughness[FILM_LANES];
	film_refine(u, s->eu);
	film_refine(v, s->ev);
	film_refine(mirror, s->mirror);
	if (rough)
		film_refine(roughness, s->rough);
	mirror_at(f->mirror, FILM_SIDE * FILM_SIDE, u, v, mirror, roughness, env, rough);
}

/* The same by lookups at the nodes alone, interpolated linearly. */
SIMD_CLONES static void film_mirror_nodes(struct quick_film *f, const struct quick_nodes *s, const struct envmap *env, bool rough)
{
	quick_four node[NODE_LANES], row[NODE_SIDE][FILM_SIDE];
	mirror_at(node, NODES_IN_TILE, s->eu, s->ev, s->mirror, s->rough, env, rough);
	for (int y = 0; y < NODE_SIDE; y++)
		for (int x = 0; x < FILM_SIDE; x++)
			row[y][x] = 0.5f * (node[y * NODE_SIDE + x / 2] + node[y * NODE_SIDE + (x + 1) / 2]);
	for (int y = 0; y < FILM_SIDE; y++)
		for (int x = 0; x < FILM_SIDE; x++)
			f->mirror[y * FILM_SIDE + x] = 0.5f * (row[y / 2][x] + row[(y + 1) / 2][x]);
}

struct span {
	float low, high, step;  // step: the longest between neighbours of the nodes
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
	return s;
}

/* Pixels between lookups of the reflection: 8, 4 or 1. Linear interpolation over a step misses an image of second derivative b by
 * step^2 b / 8; that must stay below 0.4 % of white. */
static int film_step(const struct quick_nodes *s, const struct envmap *env)
{
	const float least = 0.01f;
	enum { MOST = 6 };
	float half = 0.5f * (float)env->sharp.width, mirror = 0, bend = 0;
	struct span u = span_of(s->eu), v = span_of(s->ev);
	float step = half * (u.step > v.step ? u.step : v.step);
	int top = env->bend.width - 1, x0 = (int)((u.low + 1) * half) / ENVMAP_BLOCK, x1 = (int)((u.high + 1) * half) / ENVMAP_BLOCK;
	int y0 = (int)((v.low + 1) * half) / ENVMAP_BLOCK, y1 = (int)((v.high + 1) * half) / ENVMAP_BLOCK;
	if (x1 - x0 > MOST || y1 - y0 > MOST)
		return 1;
	for (int i = 0; i < NODES_IN_TILE; i++)
		mirror = s->mirror[i] > mirror ? s->mirror[i] : mirror;
	for (int y = y0; y <= y1 && y <= top; y++)
		for (int x = x0; x <= x1 && x <= top; x++) {
			float b = *image_at(&env->bend, x, y);
			bend = b > bend ? b : bend;
		}
	for (int px = NODE_STEP; px >= FILM_STEP; px /= 2, step *= 0.5f)
		if (mirror * bend * most_of(step * step, 1) < 3 * least)
			return px;
	return 1;
}

/* Light on the iris at the nodes, where it is smooth. */
SIMD_CLONES static void film_iris(struct quick_film *f, const struct quick_found *found, const struct quick_look *k)
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

static void film_white(struct quick_film *f, const struct quick_nodes *s, const struct quick_look *k)
{
	float sky[3][BATCH];
	quick_sclera(sky, NODE_LANES, s->nx, s->ny, s->nz, s->rho, k);
	for (int i = 0; i < NODES_IN_TILE; i++) {
		float through = k->scene->white.step * (1 - s->mirror[i]);
		f->white[i] = (quick_four){ through * sky[0][i], through * sky[1][i], through * sky[2][i], 0 };
	}
}

void quick_film_make(struct quick_film *f, struct quick_found *found, const struct quick_look *k)
{
	const struct envmap *env = k->light->mirror;
	f->step = env ? film_step(&found->nodes, env) : 0;
	if (f->step > 1)
		(f->step == NODE_STEP ? film_mirror_nodes : film_mirror)(f, &found->nodes, env, found->white);
	else
		for (int i = 0; i < FILM_SIDE * FILM_SIDE; i++)
			f->mirror[i] = (quick_four){ 0, 0, 0, 1 };
	if (found->seen)
		film_iris(f, found, k);
	if (found->white)
		film_white(f, &found->nodes, k);
}
