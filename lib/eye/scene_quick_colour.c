/* Colours of scene_quick.h: four channels at once. */
#include <math.h>
#include <string.h>

#include "eye/scene_quick.h"

#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC optimize("no-tree-pre")  // see scene_meet.c
#endif

typedef float colour __attribute__((vector_size(16), aligned(16)));

SIMD_INLINE colour read4(const float *p)
{
	colour c;
	memcpy(&c, p, sizeof c);
	return c;
}

/* Where each ray looks into a map: its first texel, and how far on. */
struct places {
	int at[BATCH];
	float u[BATCH], v[BATCH];
};

/* n texels across; coordinates times `per` plus `off`, from the first texel's centre. */
SIMD_INLINE void places_of(struct places *restrict p, const float *restrict x, const float *restrict y, float per, float off, int n, int count)
{
	float top = (float)n - 1.001f;
	SIMD_LOOP
	for (int i = 0; i < count; i++) {
		float u = x[i] * per + off, v = y[i] * per + off;
		u = u > 0 ? u < top ? u : top : 0;
		v = v > 0 ? v < top ? v : top : 0;
		int iu = (int)u, iv = (int)v;
		p->at[i] = 4 * (iv * n + iu);
		p->u[i] = u - (float)iu;
		p->v[i] = v - (float)iv;
	}
}

/* Bilinear, four channels. */
SIMD_INLINE colour look_up(const float *map, int n, const struct places *p, int i)
{
	const float *a = map + p->at[i], *b = a + 4L * n;
	colour s = read4(a), t = read4(b);
	s += p->u[i] * (read4(a + 4) - s);
	t += p->u[i] * (read4(b + 4) - t);
	return s + p->v[i] * (t - s);
}

/* Starts every ray's colour with what shows under the film: the photograph's detail times what this light makes of it. */
SIMD_CLONES static void put_iris(float rgba[][4], const struct quick_spots *s, int n, const struct quick_look *k)
{
	const struct scene_shade *h = k->shade;
	struct places p, q;
	places_of(&p, s->iu, s->iv, h->per_mm, 0.5f * (float)h->n - 0.5f, h->n, n);
	places_of(&q, s->iu, s->iv, h->light_per_mm, 0.5f * (float)h->light_n - 0.5f, h->light_n, n);
	for (int i = 0; i < n; i++) {
		float part = s->hit[i] * (1 - s->lid[i]) * (1 - s->mirror[i]);
		colour c = part > 0 ? part * look_up(h->detail, h->n, &p, i) * look_up(h->light, h->light_n, &q, i) : (colour){ 0 };
		c[3] = s->hit[i];
		memcpy(rgba[i], &c, sizeof c);
	}
}

SIMD_CLONES static void put_sclera(float rgba[][4], const struct quick_spots *s, int n, const struct quick_look *k, bool first)
{
	const struct image *map = &k->scene->veins;
	struct places p;
	places_of(&p, s->su, s->sv, (float)map->width, 0.5f * (float)map->width - 0.5f, map->width, n);
	for (int i = 0; i < n; i++) {
		colour light = { s->sky[0][i], s->sky[1][i], s->sky[2][i], 0 }, before = { 0, 0, 0, s->hit[i] };
		float part = s->hit[i] * s->lid[i] * (1 - s->mirror[i]);
		if (!first)
			memcpy(&before, rgba[i], sizeof before);
		if (part > 0)
			before += part * light * look_up(map->px, map->width, &p, i);
		memcpy(rgba[i], &before, sizeof before);
	}
}

SIMD_CLONES static void put_mirror(float rgba[][4], const struct quick_spots *s, int n, const struct envmap *env)
{
	struct places p, q;
	float w = (float)env->sharp.width, m = (float)env->rough.width;
	places_of(&p, s->eu, s->ev, 0.5f * w, 0.5f * w - 0.5f, env->sharp.width, n);
	places_of(&q, s->eu, s->ev, 0.5f * m, 0.5f * m - 0.5f, env->rough.width, n);
	for (int i = 0; i < n; i++) {
		if (s->hit[i] == 0)
			continue;
		colour c = look_up(env->sharp.px, env->sharp.width, &p, i), before;
		if (s->rough[i] > 0)
			c += s->rough[i] * (look_up(env->rough.px, env->rough.width, &q, i) - c);
		memcpy(&before, rgba[i], sizeof before);
		before += s->mirror[i] * c;
		memcpy(rgba[i], &before, sizeof before);
	}
}

/* A tile of cornea. */
SIMD_CLONES static void all_iris(float rgba[][4], const struct quick_spots *s, const struct quick_look *k)
{
	const struct scene_shade *h = k->shade;
	const struct envmap *env = k->light->mirror;
	const struct image none = { 2, 2, 4, (float[16]){ 0 } }, *sharp = env ? &env->sharp : &none;
	struct places p, q, e;
	places_of(&p, s->iu, s->iv, h->per_mm, 0.5f * (float)h->n - 0.5f, h->n, BATCH);
	places_of(&q, s->iu, s->iv, h->light_per_mm, 0.5f * (float)h->light_n - 0.5f, h->light_n, BATCH);
	places_of(&e, s->eu, s->ev, 0.5f * (float)sharp->width, 0.5f * (float)sharp->width - 0.5f, sharp->width, BATCH);
	for (int i = 0; i < BATCH; i++) {
		colour c = look_up(h->detail, h->n, &p, i) * look_up(h->light, h->light_n, &q, i), m = look_up(sharp->px, sharp->width, &e, i);
		c += s->mirror[i] * (m - c);
		c[3] = 1;
		memcpy(rgba[i], &c, sizeof c);
	}
}

/* A tile of sclera. */
SIMD_CLONES static void all_sclera(float rgba[][4], struct quick_spots *s, const struct quick_look *k)
{
	const struct envmap *env = k->light->mirror;
	const struct image none = { 2, 2, 4, (float[16]){ 0 } }, *sharp = env ? &env->sharp : &none, *rough = env ? &env->rough : &none, *map = &k->scene->veins;
	struct places p, q, e;
	float sky[3][BATCH];
	quick_sclera(s, GRID_NODES, k);
	for (int c = 0; c < 3; c++)
		quick_lay(sky[c], s->sky[c]);
	places_of(&p, s->su, s->sv, (float)map->width, 0.5f * (float)map->width - 0.5f, map->width, BATCH);
	places_of(&e, s->eu, s->ev, 0.5f * (float)sharp->width, 0.5f * (float)sharp->width - 0.5f, sharp->width, BATCH);
	places_of(&q, s->eu, s->ev, 0.5f * (float)rough->width, 0.5f * (float)rough->width - 0.5f, rough->width, BATCH);
	for (int i = 0; i < BATCH; i++) {
		colour light = { sky[0][i], sky[1][i], sky[2][i], 0 }, c = light * look_up(map->px, map->width, &p, i);
		colour m = look_up(sharp->px, sharp->width, &e, i);
		m += s->rough[i] * (look_up(rough->px, rough->width, &q, i) - m);
		c += s->mirror[i] * (m - c);
		c[3] = 1;
		memcpy(rgba[i], &c, sizeof c);
	}
}

void quick_find(struct quick_found *f, const struct quick_rays *r, const struct quick_look *k)
{
	struct quick_spots *s = &f->spots;
	float back[BATCH];
	f->kind = QUICK_MIXED;
	f->hit = f->seen = f->white = 0;
	quick_outside(s, r, k);
	for (int i = 0; i < r->n; i++) {
		f->hit += s->hit[i] > 0;
		f->seen += s->hit[i] > 0 && s->lid[i] < 1;
		f->white += s->lid[i] > 0;
	}
	if (!f->hit)
		return;
	quick_bend(f, r->n, k);
	if (f->seen)
		quick_iris(s, r, k);
	quick_reflect(s->eu, s->ev, back, f, r, k);
	quick_unfold(r->n, s->eu, s->ev, back);
}

void quick_colour(float rgba[][4], struct quick_found *f, int n, const struct quick_look *k)
{
	struct quick_spots *s = &f->spots;
	if (!f->hit) {
		memset(rgba, 0, (size_t)n * sizeof *rgba);
		return;
	}
	if (f->kind == QUICK_CORNEA) {
		all_iris(rgba, s, k);
		return;
	}
	if (f->kind == QUICK_SCLERA) {
		all_sclera(rgba, s, k);
		return;
	}
	if (f->white)
		quick_sclera(s, n, k);
	if (f->seen)
		put_iris(rgba, s, n, k);
	if (f->white)
		put_sclera(rgba, s, n, k, !f->seen);
	if (k->light->mirror)
		put_mirror(rgba, s, n, k->light->mirror);
}
