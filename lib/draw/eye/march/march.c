/* Single scattering below the relief (iris paper, section 5.3), vectorised over rays. A node of the quadrature reads the maps once;
 * all lights share that. */
#include "draw/eye/march/march.h"

#include <math.h>
#include <string.h>

#include "draw/eye/march/beside.h"
#include "math/exp2.h"

#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC optimize("no-tree-pre", "fp-contract=fast")  // see meet.c, simd.h
#endif

/* The coefficients of tissue.h's integral, times pi (a white plane's radiance is its irradiance / pi). */
struct march_tissue scene_march_tissue(const struct tissue_optics *o)
{
	struct march_tissue t = { .bands = o->n };
	for (int k = 0; k < o->n; k++) {
		for (int l = 0; l < TISSUE_LAYERS; l++) {
			t.source[l][k] = (float)fmax(log2(M_PI * o->source[l][k] * TISSUE_PHASE), -100);
			t.fade[l][k] = (float)(-M_LOG2E * o->extinction[l][k]);
		}
		for (int c = 0; c < 3; c++)
			t.rgb[c][k] = (float)(o->rgb[k][c] * o->exposure);
	}
	return t;
}

/* Adds the light of some nodes in some bands, from the first on; per[c][k]: weight in the colour. Along the direction l towards the
 * light the relief's slope changes how fast depth is lost. A slope that faces away from the light makes the path through tissue
 * long: that is the shading of the relief. */
SIMD_INLINE void light_some(int nodes, int bands, int n, float (*restrict rgb)[BATCH], int first, const struct march_node *restrict node, int band,
                            const struct march_light *restrict w, const float (*restrict per)[TISSUE_BANDS_MAX])
{
	float *restrict red = rgb[0] + first, *restrict green = rgb[1] + first, *restrict blue = rgb[2] + first;
	SIMD_LOOP
	for (int i = 0; i < n; i++) {
		float sum[4] = { 0 }, r = red[i], g = green[i], b = blue[i];
#pragma GCC unroll 3
		for (int j = 0; j < nodes; j++) {
			const struct march_node *restrict m = node + j;
			float q = m->q[i], lx = w->x[0][i] + q * w->x[1][i], ly = w->y[0][i] + q * w->y[1][i], lz = w->z[0][i] + q * w->z[1][i];
			float lost = -(lz + m->gx[i] * lx + m->gy[i] * ly), inv = 1 / (lost > 0.25f ? lost : 0.25f);
			float light = m->length[i] * (w->power[0][i] + m->u[i] * w->power[1][i]);
#pragma GCC unroll 4
			for (int k = 0; k < bands; k++)
				sum[k] += light * exp2_quick(m->rise[band + k][i] * inv + m->seen[band + k][i]);
		}
#pragma GCC unroll 4
		for (int k = 0; k < bands; k++) {
			r += per[0][band + k] * sum[k];
			g += per[1][band + k] * sum[k];
			b += per[2][band + k] * sum[k];
		}
		red[i] = r;
		green[i] = g;
		blue[i] = b;
	}
}

#define LIGHT(name, nodes, bands)                                                                                                                       \
	SIMD_CLONES static void name(int n, float (*rgb)[BATCH], int first, const struct march_node *node, int band, const struct march_light *w, \
	                             const float (*per)[TISSUE_BANDS_MAX])                                                                                      \
	{                                                                                                                                                   \
		light_some(nodes, bands, n, rgb, first, node, band, w, per);                                                                                    \
	}
LIGHT(light_1_1, 1, 1)
LIGHT(light_1_3, 1, 3)
LIGHT(light_1_4, 1, 4)
LIGHT(light_3_1, 3, 1)
LIGHT(light_3_3, 3, 3)
LIGHT(light_3_4, 3, 4)

static void light_add(struct iris_batch *r, int first, int n, int nodes, const struct march_node *node, const struct march_light *w, const struct march_tissue *t,
                      const float rgb[3])
{
	typedef void lighter(int, float (*)[BATCH], int, const struct march_node *, int, const struct march_light *, const float (*)[TISSUE_BANDS_MAX]);
	static lighter *const with[2][3] = { { light_1_1, light_1_3, light_1_4 }, { light_3_1, light_3_3, light_3_4 } };
	static const int of[3] = { 1, 3, 4 };
	float per[3][TISSUE_BANDS_MAX];
	for (int c = 0; c < 3; c++)
		for (int k = 0; k < TISSUE_BANDS_MAX; k++)
			per[c][k] = t->rgb[c][k] * rgb[c];
	for (int j = 0; j < nodes; j += nodes - j >= 3 ? 3 : 1)
		for (int k = 0; k < t->bands;) {
			int left = t->bands - k, some = left >= 4 ? 2 : left == 3 ? 1 : 0;
			with[nodes - j >= 3][some](n, r->rgb, first, node + j, k, w, (const float(*)[TISSUE_BANDS_MAX])per);
			k += of[some];
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

/* Turns values at both ends into the first and the difference. */
SIMD_CLONES static void light_ends(struct march_light *w, int n)
{
	SIMD_LOOP
	for (int i = 0; i < n; i++) {
		w->x[1][i] -= w->x[0][i];
		w->y[1][i] -= w->y[0][i];
		w->z[1][i] -= w->z[0][i];
		w->power[1][i] -= w->power[0][i];
	}
}

static void march_part(struct iris_batch *r, int first, int n, const struct scene *s, const struct ground *g, const struct scene_beams *beams,
                       const struct march_tissue *tissue)
{
	int nodes = s->n_nodes[0] + s->n_nodes[1];
	struct march_node node[nodes];
	float near[3][PART], far[3][PART];
	for (int l = 0, k = 0; l < TISSUE_LAYERS; l++)
		for (int j = 0; j < s->n_nodes[l]; j++, k++)
			scene_node_of_rays(n, &node[k], r, first, g, tissue, l, (float)s->node[l][j], (float)s->weight[l][j]);
	points(near, r, first, n, 0);
	points(far, r, first, n, 1);
	for (int k = 0; k < beams->n; k++) {
		struct march_light light;
		const struct scene_beam *beam = &beams->beam[k];
		scene_light_at(&light, 0, n, near[0], near[1], near[2], s, beam);
		scene_light_at(&light, 1, n, far[0], far[1], far[2], s, beam);
		if (s->conf.shadow > 0)
			scene_shadow(&light, n, near[0], near[1], near[2], g, s->conf.shadow);
		light_ends(&light, n);
		light_add(r, first, n, nodes, node, &light, tissue, beam->rgb);
	}
}

void scene_scatter(struct iris_batch *r, const struct scene *s, const struct scene_level *level,
                   const struct scene_beams *beams)
{
	struct ground g = ground_of(s, level);
	struct march_tissue tissue = scene_march_tissue(&s->optics);
	scene_spans(r, &g);
	memset(r->rgb, 0, sizeof r->rgb);
	for (int i = 0; i < r->n; i += PART)
		march_part(r, i, r->n - i < PART ? r->n - i : PART, s, &g, beams, &tissue);
	scene_beside_put(r->n, r->rgb[0], r->rgb[1], r->rgb[2], r->px, r->py, beams->beside, (float)s->extent);
}

void scene_scatter_tile(struct iris_batch *r, const struct march_tile *tile, const struct scene *s, const struct scene_level *level,
                        const struct scene_beams *beams, const struct march_tissue *tissue)
{
	int nodes = s->n_nodes[0] + s->n_nodes[1];
	struct march_node node[nodes];
	struct march_body body;
	struct ground g = ground_of(s, level);
	scene_tile_ground(r, tile, s, level);
	scene_body_make(&body, r, tile, s);
	for (int i = 0; i < PART; i++)
		r->rgb[0][i] = r->rgb[1][i] = r->rgb[2][i] = 0;
	for (int l = 0, k = 0; l < TISSUE_LAYERS; l++)
		for (int j = 0; j < s->n_nodes[l]; j++, k++)
			scene_node_of_tile(&node[k], r, &g, tissue, &body, l, (float)s->node[l][j], (float)s->weight[l][j]);
	for (int k = 0; k < beams->n; k++) {
		struct march_light light;
		if (scene_light_tile(&light, &body, s, &beams->beam[k]))
			light_add(r, 0, PART, nodes, node, &light, tissue, beams->beam[k].rgb);
	}
	scene_beside_put(PART, r->rgb[0], r->rgb[1], r->rgb[2], r->px, r->py, beams->beside, (float)s->extent);
}

SIMD_CLONES static void fall_add(float *restrict out, int n, const struct march_light *restrict w, float f)
{
	SIMD_LOOP
	for (int i = 0; i < n; i++)
		out[i] += f * w->power[0][i] * w->fall[0][i];
}

/* Without a march: the model's mean colour at n <= PART points, lit. */
static void flat_at(float *const rgb[3], int n, const float *x, const float *y, const float *z, const struct scene *s, const struct scene_beams *beams)
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

void scene_flat(struct iris_batch *r, const struct scene *s, const struct scene_beams *beams)
{
	for (int first = 0; first < r->n; first += PART) {
		int n = r->n - first < PART ? r->n - first : PART;
		float *rgb[3] = { r->rgb[0] + first, r->rgb[1] + first, r->rgb[2] + first };
		flat_at(rgb, n, r->px + first, r->py + first, r->pz + first, s, beams);
	}
}
