/* The iris paper's section 5.3, vectorised over rays: where a ray meets the relief, and single scattering below it. */
#include "eye/scene_impl.h"

#include <math.h>
#include <string.h>

#if defined(__GNUC__) && !defined(__clang__)
// This pass turns the bounds of relief_at and exp_negative into branches, and no loop over them is vector code then.
#pragma GCC optimize("no-tree-pre")
#endif

/* A bracket of the crossing along each ray: the relief lies below it at a, above it at b. */
struct bracket {
	float a[BATCH], fa[BATCH], b[BATCH], fb[BATCH], found[BATCH], step[BATCH];
};

/* What the loops read of the maps. */
struct ground {
	const float *relief;
	int size;
	float per_mm, z_plane, z_high, z_low, abl;
};

static struct ground ground(const struct scene *s, const struct scene_level *level)
{
	float z = (float)s->eye.iris_depth, slack = 1e-4f;  // mm: the search never starts on the very highest point
	return (struct ground){ level->relief, level->n, level->per_mm, z, z - s->height_max - slack,
	                        z - s->height_min + slack, (float)s->optics.abl_thickness };
}

SIMD_CLONES
static void search_step(int n, struct bracket *m, const struct iris_batch *r, const struct ground *g, bool last)
{
	const float *restrict fx = r->fx, *restrict fy = r->fy, *restrict fz = r->fz, *restrict relief = g->relief;
	const float *restrict vx = r->vx, *restrict vy = r->vy, *restrict vz = r->vz, *restrict step = m->step;
	float *restrict a = m->a, *restrict fa = m->fa, *restrict b = m->b, *restrict fb = m->fb, *restrict found = m->found;
	float per_mm = g->per_mm, z_plane = g->z_plane;
	int size = g->size;
	SIMD_LOOP
	for (int i = 0; i < n; i++) {
		float t = a[i] + step[i], gx, gy, x = fx[i] + t * vx[i], y = fy[i] + t * vy[i];
		float f = fz[i] + t * vz[i] - z_plane + relief_at(relief, size, per_mm, x, y, &gx, &gy);
		float old = found[i], now = old > 0 ? 1.0f : f >= 0 || last ? 1.0f : 0.0f;
		float b0 = b[i], fb0 = fb[i], a0 = a[i], fa0 = fa[i];
		b[i] = old > 0 ? b0 : t;
		fb[i] = old > 0 ? fb0 : f;
		a[i] = now > 0 ? a0 : t;
		fa[i] = now > 0 ? fa0 : f;
		found[i] = now;
	}
}

/* Regula falsi: the relief is nearly straight inside the bracket. */
SIMD_CLONES
static void falsi_step(int n, struct bracket *m, const struct iris_batch *r, const struct ground *g)
{
	const float *restrict fx = r->fx, *restrict fy = r->fy, *restrict fz = r->fz, *restrict relief = g->relief;
	const float *restrict vx = r->vx, *restrict vy = r->vy, *restrict vz = r->vz;
	float *restrict a = m->a, *restrict fa = m->fa, *restrict b = m->b, *restrict fb = m->fb;
	float per_mm = g->per_mm, z_plane = g->z_plane;
	int size = g->size;
	SIMD_LOOP
	for (int i = 0; i < n; i++) {
		float a0 = a[i], fa0 = fa[i], b0 = b[i], fb0 = fb[i], d = fb0 - fa0 + 1e-12f;
		float t = a0 - fa0 * (b0 - a0) / d, gx, gy, x = fx[i] + t * vx[i], y = fy[i] + t * vy[i];
		float f = fz[i] + t * vz[i] - z_plane + relief_at(relief, size, per_mm, x, y, &gx, &gy);
		b[i] = f >= 0 ? t : b0;
		fb[i] = f >= 0 ? f : fb0;
		a[i] = f >= 0 ? a0 : t;
		fa[i] = f >= 0 ? fa0 : f;
	}
}

void scene_meet(struct iris_batch *r, const struct scene *s, const struct scene_level *level)
{
	struct bracket m;
	struct ground g = ground(s, level);
	for (int i = 0; i < r->n; i++) {
		float start = (g.z_high - r->fz[i]) / r->vz[i], end = (g.z_low - r->fz[i]) / r->vz[i];
		m.a[i] = start;
		m.fa[i] = -1e-6f;
		m.step[i] = (end - start) / (float)s->conf.search;
		m.found[i] = 0;
	}
	for (int k = 1; k <= s->conf.search; k++)
		search_step(r->n, &m, r, &g, k == s->conf.search);
	for (int k = 0; k < 2; k++)
		falsi_step(r->n, &m, r, &g);
	for (int i = 0; i < r->n; i++) {
		float d = m.fb[i] - m.fa[i], t = d > 1e-12f ? m.a[i] - m.fa[i] * (m.b[i] - m.a[i]) / d : m.b[i];
		r->px[i] = r->fx[i] + t * r->vx[i];
		r->py[i] = r->fy[i] + t * r->vy[i];
		r->pz[i] = r->fz[i] + t * r->vz[i];
	}
}

/* How far the ray goes on in each layer: down to the epithelium, which lies the layers' thickness below the relief. */
SIMD_CLONES
static void spans(struct iris_batch *r, const struct ground *g)
{
	const float *restrict px = r->px, *restrict py = r->py, *restrict pz = r->pz, *restrict relief = g->relief;
	const float *restrict vx = r->vx, *restrict vy = r->vy, *restrict vz = r->vz;
	float *restrict near = r->near, *restrict span = r->span;
	float per_mm = g->per_mm, z_plane = g->z_plane, abl = g->abl;
	int size = g->size;
	SIMD_LOOP
	for (int i = 0; i < r->n; i++) {
		float gx, gy, hx, hy;
		relief_at(relief, size, per_mm, px[i], py[i], &gx, &gy);
		float rate = vz[i] + gx * vx[i] + gy * vy[i];  // depth below the relief gained in a mm of the way
		rate = rate > 0.2f ? rate : 0.2f;
		float thick = channel_at(relief, size, per_mm, px[i], py[i], 2, 1);
		float s = (abl + thick) / rate, most = 3 * (abl + thick);
		for (int k = 0; k < 2; k++) {
			float x = px[i] + s * vx[i], y = py[i] + s * vy[i];
			float depth = pz[i] + s * vz[i] - z_plane + relief_at(relief, size, per_mm, x, y, &hx, &hy);
			s += (abl + channel_at(relief, size, per_mm, x, y, 2, 1) - depth) / vz[i];
			s = s > 1e-3f ? s < most ? s : most : 1e-3f;
		}
		span[i] = s;
		float a = abl / rate;
		near[i] = a < s ? a : s;
	}
}

/* One light on its way to a batch. K at the near and the far end of each ray; what a node of the march makes of it. */
struct lit {
	float K0[4][BATCH], K1[4][BATCH];
	float la[BATCH], ls[BATCH];  // way in the two layers, to and fro
	float w[BATCH];              // light times length
};

/* at, weight: of the quadrature, on 0..1 of its layer. */
SIMD_CLONES
static void node_paths(struct lit *m, const struct iris_batch *r, const struct ground *g, bool stroma, float at,
                       float weight)
{
	const float *restrict px = r->px, *restrict py = r->py, *restrict pz = r->pz, *restrict relief = g->relief;
	const float *restrict vx = r->vx, *restrict vy = r->vy, *restrict vz = r->vz, *restrict near = r->near;
	const float *restrict span = r->span, *restrict kx0 = m->K0[0], *restrict ky0 = m->K0[1], *restrict kz0 = m->K0[2];
	const float *restrict kx1 = m->K1[0], *restrict ky1 = m->K1[1], *restrict kz1 = m->K1[2];
	const float *restrict gain0 = m->K0[3], *restrict gain1 = m->K1[3];
	float *restrict la = m->la, *restrict ls = m->ls, *restrict w = m->w;
	float per_mm = g->per_mm, z_plane = g->z_plane, abl = g->abl;
	int size = g->size;
	float of_span = stroma ? 1 : 0, of_near = 1 - 2 * of_span;
	SIMD_LOOP
	for (int i = 0; i < r->n; i++) {
		float length = of_span * span[i] + of_near * near[i];
		float s = of_span * near[i] + at * length, u = s / span[i], gx, gy;
		float x = px[i] + s * vx[i], y = py[i] + s * vy[i], z = pz[i] + s * vz[i];
		float depth = z - z_plane + relief_at(relief, size, per_mm, x, y, &gx, &gy);
		depth = depth > 0 ? depth : 0;
		float lx = kx0[i] + u * (kx1[i] - kx0[i]) - x, ly = ky0[i] + u * (ky1[i] - ky0[i]) - y,
		      lz = kz0[i] + u * (kz1[i] - kz0[i]) - z;
		float inv = 1 / sqrtf(lx * lx + ly * ly + lz * lz);
		lx *= inv;
		ly *= inv;
		lz *= inv;
		// Up along l the relief falls away by its slope: depth lost in a mm of the way. A slope that faces away from
		// the light makes the way long: that is the shading of the relief.
		float lost = -lz - gx * lx - gy * ly;
		lost = lost > 0.25f ? lost : 0.25f;
		float in_abl = (depth < abl ? depth : abl) / lost, in_stroma = (depth > abl ? depth - abl : 0) / lost;
		la[i] = in_abl + (s < near[i] ? s : near[i]);
		ls[i] = in_stroma + (s > near[i] ? s - near[i] : 0);
		float cos_plane = -lz > 0.05f ? -lz : 0.05f;
		w[i] = weight * length * (gain0[i] + u * (gain1[i] - gain0[i])) / cos_plane;
	}
}

/* exp of what is not positive, to 2e-7: 2^k times a polynomial. */
SIMD_INLINE float exp_negative(float x)
{
	x = x > -80 ? x : -80;
	float t = x * 1.44269504f, k = (float)(int)(t - 0.5f), f = t - k, p = 1.54035304e-4f;
	p = p * f + 1.33335581e-3f;
	p = p * f + 9.61812911e-3f;
	p = p * f + 5.55041087e-2f;
	p = p * f + 2.40226507e-1f;
	p = p * f + 6.93147181e-1f;
	p = p * f + 1;
	union {
		int i;
		float f;
	} scale = { ((int)k + 127) << 23 };
	return p * scale.f;
}

SIMD_CLONES
static void band_add(int n, float *restrict sum, const float *restrict la, const float *restrict ls,
                     const float *restrict w, float source, float ea, float es)
{
	SIMD_LOOP
	for (int i = 0; i < n; i++)
		sum[i] += source * w[i] * exp_negative(-(ea * la[i] + es * ls[i]));
}

/* How much of a source of 0.15 rad stands clear of the relief, looking from a batch's points at the part `part` of the
 * way out of the relief's reach. 4 um of bias: a surface does not shadow itself. */
SIMD_CLONES
static void shadow_step(float *restrict least, const struct lit *m, const struct iris_batch *r, const struct ground *g,
                        float part)
{
	const float *restrict px = r->px, *restrict py = r->py, *restrict pz = r->pz, *restrict relief = g->relief;
	const float *restrict kx = m->K0[0], *restrict ky = m->K0[1], *restrict kz = m->K0[2];
	float per_mm = g->per_mm, z_plane = g->z_plane, z_high = g->z_high;
	int size = g->size;
	SIMD_LOOP
	for (int i = 0; i < r->n; i++) {
		float x = px[i], y = py[i], z = pz[i], lx = kx[i] - x, ly = ky[i] - y, lz = kz[i] - z, gx, gy;
		float up = lz < -0.2f ? lz : -0.2f, t = part * (z_high - z) / up;  // t: in units of the way to K
		float h = z_plane - relief_at(relief, size, per_mm, x + t * lx, y + t * ly, &gx, &gy);
		float off = t * sqrtf(lx * lx + ly * ly), clear = (h - (z + t * lz) + 0.004f) / (0.15f * off + 0.004f), old = least[i];
		least[i] = clear < old ? clear : old;
	}
}

/* Dims the light by the share that the relief between it and the point lets through. A shadow is not black: tissue that
 * stands around it in the light fills it in. */
static void shadow(struct lit *m, const struct iris_batch *r, const struct ground *g, int steps)
{
	static const float fill = 0.4f;
	float least[BATCH];
	for (int i = 0; i < r->n; i++)
		least[i] = 1;
	for (int k = 1; k <= steps; k++)
		shadow_step(least, m, r, g, (float)k / (float)steps);
	for (int i = 0; i < r->n; i++) {
		float open = fill + (1 - fill) * (least[i] > 0 ? least[i] : 0);
		m->K0[3][i] *= open;
		m->K1[3][i] *= open;
	}
}

static void add_light(struct iris_batch *r, const struct tissue_optics *o, const float rgb[3], const float (*sum)[BATCH])
{
	for (int c = 0; c < 3; c++)
		for (int k = 0; k < o->n; k++) {
			float f = (float)(o->rgb[k][c] * o->exposure * rgb[c]);
			for (int i = 0; i < r->n; i++)
				r->rgb[c][i] += f * sum[k][i];
		}
}

/* All nodes of both layers, one light: tissue.h's integral, times pi (a white plane's radiance is its irradiance / pi). */
static void march(float (*sum)[BATCH], struct lit *m, const struct iris_batch *r, const struct ground *g,
                  const struct scene *s)
{
	const struct tissue_optics *o = &s->optics;
	for (int l = 0; l < TISSUE_LAYERS; l++)
		for (int j = 0; j < s->n_nodes[l]; j++) {
			node_paths(m, r, g, l == TISSUE_STROMA, (float)s->node[l][j], (float)s->weight[l][j]);
			for (int k = 0; k < o->n; k++)
				band_add(r->n, sum[k], m->la, m->ls, m->w, (float)(M_PI * o->source[l][k] * TISSUE_PHASE),
				         (float)o->extinction[TISSUE_ABL][k], (float)o->extinction[TISSUE_STROMA][k]);
		}
}

void scene_scatter(struct iris_batch *r, const struct scene *s, const struct scene_level *level,
                   const struct scene_beams *beams)
{
	static const float zero[BATCH];
	struct ground g = ground(s, level);
	struct lit m;
	float sum[TISSUE_BANDS_MAX][BATCH];
	spans(r, &g);
	memset(r->rgb, 0, sizeof r->rgb);
	for (int l = 0; l < beams->n; l++) {
		const struct scene_beam *beam = &beams->beam[l];
		scene_beam_paths(m.K0, r, zero, s, beam);
		scene_beam_paths(m.K1, r, r->span, s, beam);
		if (s->conf.shadow > 0)
			shadow(&m, r, &g, s->conf.shadow);
		memset(sum, 0, sizeof sum);
		march(sum, &m, r, &g, s);
		add_light(r, &s->optics, beam->rgb, (const float(*)[BATCH])sum);
	}
}

void scene_flat(struct iris_batch *r, const struct scene *s, const struct scene_beams *beams)
{
	static const float zero[BATCH];
	float K[4][BATCH];
	memset(r->rgb, 0, sizeof r->rgb);
	for (int l = 0; l < beams->n; l++) {
		scene_beam_paths(K, r, zero, s, &beams->beam[l]);
		for (int c = 0; c < 3; c++)
			for (int i = 0; i < r->n; i++)
				r->rgb[c][i] += beams->beam[l].rgb[c] * s->flat[c] * K[3][i];
	}
}
