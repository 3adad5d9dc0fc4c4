/* Colours of quick.h: four channels at once. */
#include <math.h>
#include <string.h>

#include "draw/eye/quick/quick.h"

#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC optimize("no-tree-pre")  // see draw/eye/march/meet.c
#endif

/* Starts every ray's colour with the iris under the film: the photograph's detail times the march's light. */
SIMD_CLONES static void put_iris(float rgba[][4], const struct quick_spots *s, int n, const struct quick_look *k)
{
	const struct scene_shade *h = k->shade;
	struct quick_places p, q;
	quick_places_of(&p, s->iu, s->iv, h->per_mm, 0.5f * (float)h->detail->n - 0.5f, h->detail->n, h->detail->stride, n);
	quick_places_of(&q, s->iu, s->iv, h->light_per_mm, 0.5f * (float)h->light_n - 0.5f, h->light_n, h->light_stride, n);
	for (int i = 0; i < n; i++) {
		float part = s->hit[i] * (1 - s->lid[i]) * (1 - s->mirror[i]);
		quick_four c = part > 0 ? part * h->detail->step * quick_texel(h->detail, &p, i) * quick_look_up(h->light, h->light_stride, &q, i) : (quick_four){ 0 };
		c[3] = s->hit[i];
		memcpy(rgba[i], &c, sizeof c);
	}
}

SIMD_CLONES static void put_sclera(float rgba[][4], const struct quick_spots *s, int n, const struct quick_look *k, bool first)
{
	const struct scene_texels *map = &k->scene->white;
	struct quick_places p;
	quick_places_of(&p, s->su, s->sv, (float)map->n, 0.5f * (float)map->n - 0.5f, map->n, map->stride, n);
	for (int i = 0; i < n; i++) {
		quick_four light = { s->sky[0][i], s->sky[1][i], s->sky[2][i], 0 }, before = { 0, 0, 0, s->hit[i] };
		float part = s->hit[i] * s->lid[i] * (1 - s->mirror[i]) * map->step;
		if (!first)
			memcpy(&before, rgba[i], sizeof before);
		if (part > 0)
			before += part * light * quick_texel(map, &p, i);
		memcpy(rgba[i], &before, sizeof before);
	}
}

SIMD_CLONES static void put_mirror(float rgba[][4], const struct quick_spots *s, int n, const struct envmap *env)
{
	struct quick_places p, q;
	float w = (float)env->sharp.width, m = (float)env->rough.width;
	quick_places_of(&p, s->eu, s->ev, 0.5f * w, 0.5f * w - 0.5f, env->sharp.width, env->sharp.width, n);
	quick_places_of(&q, s->eu, s->ev, 0.5f * m, 0.5f * m - 0.5f, env->rough.width, env->rough.width, n);
	for (int i = 0; i < n; i++) {
		if (s->hit[i] == 0)
			continue;
		quick_four c = quick_look_up(env->sharp.px, env->sharp.width, &p, i), before;
		if (s->rough[i] > 0)
			c += s->rough[i] * (quick_look_up(env->rough.px, env->rough.width, &q, i) - c);
		memcpy(&before, rgba[i], sizeof before);
		before += s->mirror[i] * c;
		memcpy(rgba[i], &before, sizeof before);
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
	if (f->white)
		quick_sclera(s->sky, n, s->nx, s->ny, s->nz, s->rho, k);
	if (f->seen)
		put_iris(rgba, s, n, k);
	if (f->white)
		put_sclera(rgba, s, n, k, !f->seen);
	if (k->light->mirror)
		put_mirror(rgba, s, n, k->light->mirror);
}
