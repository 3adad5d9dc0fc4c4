/* Nodes of the quadrature: what is read of the maps, once for all lights. */
#include "draw/eye/march/march.h"
#include "draw/eye/quick/map.h"

#include <string.h>

#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC optimize("no-tree-pre")  // see meet.c
#endif

/* at, weight: of the quadrature, on 0..1 of its layer. r: the part's first ray on. pairs: a tile's rays, on its maps. */
SIMD_INLINE void node_make(int n, struct march_node *restrict m, const struct iris_batch *restrict r, int first, const struct ground *g,
                           const struct march_tissue *t, bool pairs, int layer, float at, float weight)
{
	const float *restrict px = r->px + first, *restrict py = r->py + first, *restrict pz = r->pz + first;
	const float *restrict vx = r->vx + first, *restrict vy = r->vy + first, *restrict vz = r->vz + first;
	const float *restrict near = r->near + first, *restrict span = r->span + first, *restrict relief = g->relief;
	const int *restrict pair = g->pairs;
	float per_mm = g->per_mm, z_plane = g->z_plane, abl = g->abl, over[PART], under[PART], seen_over[PART], seen_under[PART];
	int size = g->size;
	float of_span = layer == TISSUE_STROMA ? 1 : 0, of_near = 1 - 2 * of_span;
	SIMD_LOOP
	for (int i = 0; i < n; i++) {
		float thick = of_span * span[i] + of_near * near[i], s = of_span * near[i] + at * thick, gx, gy;
		float x = px[i] + s * vx[i], y = py[i] + s * vy[i], z = pz[i] + s * vz[i];
		float depth = z - z_plane + (pairs ? quick_height_at(pair, size, per_mm, x, y, &gx, &gy) : relief_at(relief, size, per_mm, x, y, &gx, &gy));
		depth = depth > 0 ? depth : 0;
		m->u[i] = s / span[i];
		m->gx[i] = gx;
		m->gy[i] = gy;
		m->length[i] = weight * thick;
		over[i] = depth < abl ? depth : abl;
		under[i] = depth > abl ? depth - abl : 0;
		seen_over[i] = s < near[i] ? s : near[i];
		seen_under[i] = s > near[i] ? s - near[i] : 0;
	}
	// Lower bounds: darker is black, and four times rise plus seen stays within a float's exponents.
	for (int k = 0; k < t->bands; k++) {
		float of_over = t->fade[TISSUE_ABL][k], of_under = t->fade[TISSUE_STROMA][k], source = t->source[layer][k];
		SIMD_LOOP
		for (int i = 0; i < n; i++) {
			float rise = over[i] * of_over + under[i] * of_under, seen = seen_over[i] * of_over + seen_under[i] * of_under + source;
			m->rise[k][i] = rise > -16 ? rise : -16;
			m->seen[k][i] = seen > -56 ? seen : -56;
		}
	}
}

SIMD_CLONES void scene_node_of_rays(int n, struct march_node *m, const struct iris_batch *r, int first, const struct ground *g,
                                    const struct march_tissue *t, int layer, float at, float weight)
{
	node_make(n, m, r, first, g, t, false, layer, at, weight);
	memcpy(m->q, m->u, sizeof m->u);
}

SIMD_CLONES void scene_node_of_tile(struct march_node *m, const struct iris_batch *r, const struct ground *g, const struct march_tissue *t,
                                    const struct march_body *body, int layer, float at, float weight)
{
	node_make(PART, m, r, 0, g, t, true, layer, at, weight);
	SIMD_LOOP
	for (int i = 0; i < PART; i++)
		m->q[i] = body->q[0][i] + m->u[i] * (body->q[1][i] - body->q[0][i]);
}
