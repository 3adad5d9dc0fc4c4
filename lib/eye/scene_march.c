/* The iris paper's section 5.3, vectorised over rays: single scattering below the relief. What a node of the quadrature
 * needs of the maps is the same for every light, and is read once. */
#include "eye/scene_march.h"

#include <math.h>
#include <string.h>

#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC optimize("no-tree-pre", "fp-contract=fast")  // see scene_meet.c, simd.h
#endif

/* at, weight: of the quadrature, on 0..1 of its layer. r: the part's first ray on. */
SIMD_CLONES
static void node_make(int n, struct march_node *m, const struct iris_batch *r, int first, const struct ground *g, bool stroma,
                      float at, float weight)
{
	const float *restrict px = r->px + first, *restrict py = r->py + first, *restrict pz = r->pz + first;
	const float *restrict vx = r->vx + first, *restrict vy = r->vy + first, *restrict vz = r->vz + first;
	const float *restrict near = r->near + first, *restrict span = r->span + first, *restrict relief = g->relief;
	float *restrict u = m->u, *restrict slope_x = m->gx, *restrict slope_y = m->gy, *restrict length = m->length;
	float *restrict above_abl = m->above[0], *restrict above_stroma = m->above[1];
	float *restrict seen_abl = m->seen[0], *restrict seen_stroma = m->seen[1];
	float per_mm = g->per_mm, z_plane = g->z_plane, abl = g->abl;
	int size = g->size;
	float of_span = stroma ? 1 : 0, of_near = 1 - 2 * of_span;
	SIMD_LOOP
	for (int i = 0; i < n; i++) {
		float layer = of_span * span[i] + of_near * near[i], s = of_span * near[i] + at * layer, gx, gy;
		float x = px[i] + s * vx[i], y = py[i] + s * vy[i], z = pz[i] + s * vz[i];
		float depth = z - z_plane + relief_at(relief, size, per_mm, x, y, &gx, &gy);
		depth = depth > 0 ? depth : 0;
		u[i] = s / span[i];
		slope_x[i] = gx;
		slope_y[i] = gy;
		above_abl[i] = depth < abl ? depth : abl;
		above_stroma[i] = depth > abl ? depth - abl : 0;
		seen_abl[i] = s < near[i] ? s : near[i];
		seen_stroma[i] = s > near[i] ? s - near[i] : 0;
		length[i] = weight * layer;
	}
}

/* exp2 of what is not positive, to 1e-4: a cubic on -1/2..1/2 times a power of 2, which is added to its exponent. The nearest
 * whole number is what a sum with 1.5 2^23 is rounded to. */
SIMD_INLINE float exp2_negative(float t)
{
	t = t > -120 ? t : -120;
	union {
		float f;
		unsigned i;
	} whole = { t + 12582912.0f }, p;
	float f = t - (whole.f - 12582912.0f);
	p.f = ((5.517167e-2f * f + 0.24261112f) * f + 0.69326099f) * f + 0.99992807f;
	p.i += whole.i << 23;
	return p.f;
}

/* What a layer makes of light, in every band: per mm, of 2. */
struct rates {
	float source[TISSUE_BANDS_MAX], fade[TISSUE_LAYERS][TISSUE_BANDS_MAX];
};

/* One node, one light, all bands: adds to sum[band][ray]. Up along l the relief falls away by its slope: depth lost in a
 * mm of the way. A slope that faces away from the light makes the way long: that is the shading of the relief. */
SIMD_INLINE void node_light(int n, int bands, float (*restrict sum)[PART], const struct march_node *restrict m,
                            const struct march_light *restrict w, const struct rates *restrict r)
{
	SIMD_LOOP
	for (int i = 0; i < n; i++) {
		float u = m->u[i], lx = w->x[0][i] + u * (w->x[1][i] - w->x[0][i]), ly = w->y[0][i] + u * (w->y[1][i] - w->y[0][i]),
		      lz = w->z[0][i] + u * (w->z[1][i] - w->z[0][i]), lost = -lz - m->gx[i] * lx - m->gy[i] * ly;
		float inv = 1 / (lost > 0.25f ? lost : 0.25f);
		float a = m->above[0][i] * inv + m->seen[0][i], b = m->above[1][i] * inv + m->seen[1][i];
		float light = m->length[i] * (w->power[0][i] + u * (w->power[1][i] - w->power[0][i]));
#pragma GCC unroll 8
		for (int k = 0; k < bands; k++)
			sum[k][i] += r->source[k] * light * exp2_negative(a * r->fade[0][k] + b * r->fade[1][k]);
	}
}

SIMD_CLONES static void node_light_3(int n, float (*sum)[PART], const struct march_node *m, const struct march_light *w, const struct rates *r)
{
	node_light(n, 3, sum, m, w, r);
}

SIMD_CLONES static void node_light_4(int n, float (*sum)[PART], const struct march_node *m, const struct march_light *w, const struct rates *r)
{
	node_light(n, 4, sum, m, w, r);
}

SIMD_CLONES static void node_light_1(int n, float (*sum)[PART], const struct march_node *m, const struct march_light *w, const struct rates *r)
{
	node_light(n, 1, sum, m, w, r);
}

static void node_lights(int n, int bands, float (*sum)[PART], const struct march_node *m, const struct march_light *w, const struct rates *r)
{
	if (bands == 4) {
		node_light_4(n, sum, m, w, r);
		return;
	}
	int k = bands / 3 * 3;
	for (int from = 0; from < bands; from += from < k ? 3 : 1) {
		struct rates part;
		for (int j = 0; j < 3 && from + j < bands; j++) {
			part.source[j] = r->source[from + j];
			part.fade[0][j] = r->fade[0][from + j];
			part.fade[1][j] = r->fade[1][from + j];
		}
		(from < k ? node_light_3 : node_light_1)(n, sum + from, m, w, &part);
	}
}

/* tissue.h's integral, times pi (a white plane's radiance is its irradiance / pi). */
static struct rates rates_of(const struct tissue_optics *o, int layer)
{
	struct rates r = { 0 };
	for (int k = 0; k < o->n; k++) {
		r.source[k] = (float)(M_PI * o->source[layer][k] * TISSUE_PHASE);
		for (int l = 0; l < TISSUE_LAYERS; l++)
			r.fade[l][k] = (float)(-M_LOG2E * o->extinction[l][k]);
	}
	return r;
}

/* Bands' sums as one colour: per[c][k] of band k. */
SIMD_INLINE void colour_add(float (*restrict rgb)[BATCH], int first, int n, int bands, const float per[3][TISSUE_BANDS_MAX], const float (*restrict sum)[PART])
{
	for (int c = 0; c < 3; c++) {
		float *restrict to = rgb[c] + first;
		SIMD_LOOP
		for (int i = 0; i < n; i++) {
			float all = to[i];
#pragma GCC unroll 8
			for (int k = 0; k < bands; k++)
				all += per[c][k] * sum[k][i];
			to[i] = all;
		}
	}
}

SIMD_CLONES static void colour_add_4(float (*rgb)[BATCH], int first, int n, const float per[3][TISSUE_BANDS_MAX], const float (*sum)[PART])
{
	colour_add(rgb, first, n, 4, per, sum);
}

SIMD_CLONES static void colour_add_1(float (*rgb)[BATCH], int first, int n, const float per[3][TISSUE_BANDS_MAX], const float (*sum)[PART])
{
	colour_add(rgb, first, n, 1, per, sum);
}

static void add_light(struct iris_batch *r, int first, int n, const struct tissue_optics *o, const float rgb[3], const float (*sum)[PART])
{
	for (int from = 0; from < o->n;) {
		bool four = from + 4 <= o->n;
		float per[3][TISSUE_BANDS_MAX];
		for (int c = 0; c < 3; c++)
			for (int k = 0; k < (four ? 4 : 1); k++)
				per[c][k] = (float)(o->rgb[from + k][c] * o->exposure * rgb[c]);
		(four ? colour_add_4 : colour_add_1)(r->rgb, first, n, per, sum + from);
		from += four ? 4 : 1;
	}
}

/* Points of a part's rays at the share u of each. */
static void points(float p[3][PART], const struct iris_batch *r, int first, int n, float u)
{
	for (int i = 0; i < n; i++) {
		float s = u * r->span[first + i];
		p[0][i] = r->px[first + i] + s * r->vx[first + i];
		p[1][i] = r->py[first + i] + s * r->vy[first + i];
		p[2][i] = r->pz[first + i] + s * r->vz[first + i];
	}
}

static void nodes_make(struct march_node *node, const struct iris_batch *r, int first, int n, const struct scene *s, const struct ground *g)
{
	for (int l = 0, k = 0; l < TISSUE_LAYERS; l++)
		for (int j = 0; j < s->n_nodes[l]; j++, k++)
			node_make(n, &node[k], r, first, g, l == TISSUE_STROMA, (float)s->node[l][j], (float)s->weight[l][j]);
}

static void light_add(struct iris_batch *r, int first, int n, const struct scene *s, const struct march_node *node,
                      const struct march_light *light, const float rgb[3], const struct rates rates[TISSUE_LAYERS])
{
	float sum[TISSUE_BANDS_MAX][PART];
	for (int k = 0; k < s->optics.n; k++)
		memset(sum[k], 0, sizeof sum[k]);
	for (int l = 0, k = 0; l < TISSUE_LAYERS; l++)
		for (int j = 0; j < s->n_nodes[l]; j++, k++)
			node_lights(n, s->optics.n, sum, &node[k], light, &rates[l]);
	add_light(r, first, n, &s->optics, rgb, (const float(*)[PART])sum);
}

static void march_part(struct iris_batch *r, int first, int n, const struct scene *s, const struct ground *g, const struct scene_beams *beams)
{
	struct march_node node[s->n_nodes[0] + s->n_nodes[1]];
	const struct rates rates[TISSUE_LAYERS] = { rates_of(&s->optics, 0), rates_of(&s->optics, 1) };
	float near[3][PART], far[3][PART];
	nodes_make(node, r, first, n, s, g);
	points(near, r, first, n, 0);
	points(far, r, first, n, 1);
	for (int k = 0; k < beams->n; k++) {
		struct march_light light;
		const struct scene_beam *beam = &beams->beam[k];
		scene_light_at(&light, 0, n, near[0], near[1], near[2], s, beam);
		scene_light_at(&light, 1, n, far[0], far[1], far[2], s, beam);
		if (s->conf.shadow > 0)
			scene_shadow(&light, n, near[0], near[1], near[2], g, s->conf.shadow);
		light_add(r, first, n, s, node, &light, beam->rgb, rates);
	}
}

void scene_scatter(struct iris_batch *r, const struct scene *s, const struct scene_level *level,
                   const struct scene_beams *beams)
{
	struct ground g = ground_of(s, level);
	scene_spans(r, &g);
	memset(r->rgb, 0, sizeof r->rgb);
	for (int i = 0; i < r->n; i += PART)
		march_part(r, i, r->n - i < PART ? r->n - i : PART, s, &g, beams);
}

void scene_scatter_tile(struct iris_batch *r, const struct march_tile *tile, const struct scene *s, const struct scene_level *level,
                        const struct scene_beams *beams)
{
	struct march_node node[s->n_nodes[0] + s->n_nodes[1]];
	struct march_body body;
	const struct rates rates[TISSUE_LAYERS] = { rates_of(&s->optics, 0), rates_of(&s->optics, 1) };
	scene_tile_ground(r, tile, s, level);
	scene_body_make(&body, r, tile);
	for (int i = 0; i < PART; i++)
		r->rgb[0][i] = r->rgb[1][i] = r->rgb[2][i] = 0;
	for (int l = 0, k = 0; l < TISSUE_LAYERS; l++)
		for (int j = 0; j < s->n_nodes[l]; j++, k++)
			scene_tile_node(&node[k], r, s, level, l, j);
	for (int k = 0; k < beams->n; k++) {
		struct march_light light;
		if (scene_light_tile(&light, &body, s, &beams->beam[k]))
			light_add(r, 0, PART, s, node, &light, beams->beam[k].rgb, rates);
	}
}

void scene_flat(struct iris_batch *r, const struct scene *s, const struct scene_beams *beams)
{
	for (int first = 0; first < r->n; first += PART) {
		int n = r->n - first < PART ? r->n - first : PART;
		float *rgb[3] = { r->rgb[0] + first, r->rgb[1] + first, r->rgb[2] + first };
		scene_flat_at(rgb, n, r->px + first, r->py + first, r->pz + first, s, beams);
	}
}

SIMD_CLONES static void fall_add(float *restrict out, int n, const struct march_light *restrict w, float f)
{
	SIMD_LOOP
	for (int i = 0; i < n; i++)
		out[i] += f * w->power[0][i] * w->fall[0][i];
}

void scene_flat_at(float *const rgb[3], int n, const float *x, const float *y, const float *z, const struct scene *s, const struct scene_beams *beams)
{
	struct march_light w;
	for (int c = 0; c < 3; c++)
		memset(rgb[c], 0, (size_t)n * sizeof *rgb[c]);
	for (int l = 0; l < beams->n; l++) {
		scene_light_at(&w, 0, n, x, y, z, s, &beams->beam[l]);
		for (int c = 0; c < 3; c++)
			fall_add(rgb[c], n, &w, beams->beam[l].rgb[c] * s->flat[c]);
	}
}
