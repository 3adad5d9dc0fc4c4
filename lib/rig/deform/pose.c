/* Algorithm 1 (deform.h), a block of vertices at a time. */
#include <math.h>
#include <string.h>

#include "math/simd.h"
#include "math/vec.h"
#include "rig/deform/deform.h"
#include "rig/deform/impl.h"

enum { BLOCK = DEFORM_BLOCK };

/* Two neighbouring texels, and one. */
typedef float texel_pair __attribute__((vector_size(64), aligned(32)));
typedef float texel_row __attribute__((vector_size(32), aligned(32)));
_Static_assert(RIG_SKIN_COMPONENTS == 4 && RIG_LID_COMPONENTS == 4, "components are added in fours");
_Static_assert(sizeof(texel_row) == SKULL_CHANNELS * sizeof(float), "a texel is one vector");

/* A block being evaluated: skin coordinates, positions, normals. */
struct block {
	float u[2][BLOCK], x[3][BLOCK], n[3][BLOCK];
};

/* A globe in the pose: rotation globe_from_target, row-major; centre. */
struct globe {
	float R[9], o[3];
	const struct globe_map *map;
};

SIMD_INLINE void add_four(float *restrict u, const float (*restrict basis)[BLOCK], const float *e, int n)
{
	SIMD_LOOP
	for (int i = 0; i < n; i++)
		u[i] += (basis[0][i] * e[0] + basis[1][i] * e[1]) + (basis[2][i] * e[2] + basis[3][i] * e[3]);
}

SIMD_INLINE void skin_coordinates(struct block *restrict b, const struct deform_terms_block *t, const float e[RIG_COMPONENTS], int n, bool lids)
{
	for (int c = 0; c < 2; c++) {
		memcpy(b->u[c], t->mean[c], sizeof b->u[c]);
		add_four(b->u[c], t->skin[c], e, n);
		if (lids)
			add_four(b->u[c], t->lids[c], e + RIG_SKIN_COMPONENTS, n);
	}
}

/* Equations 3.15 and 3.16: position and normal by bilinear interpolation of the skull map. */
SIMD_INLINE void on_skull(struct block *restrict b, const struct deform_terms_block *t, const struct skull_map *map, int n, bool normals)
{
	float k = 1 / (float)map->step, x0 = (float)map->x0, y0 = (float)map->y0;
	float wide = (float)map->width - 1.001f, high = (float)map->height - 1.001f, texel[BLOCK][SKULL_CHANNELS] __attribute__((aligned(64)));
	int width = map->width, at[BLOCK];
	SIMD_LOOP
	for (int i = 0; i < n; i++) {
		float u = (b->u[0][i] - x0) * k, v = (b->u[1][i] - y0) * k;
		u = u > 0 ? u : 0;
		v = v > 0 ? v : 0;
		u = u < wide ? u : wide;
		v = v < high ? v : high;
		int iu = (int)u, iv = (int)v;
		at[i] = iv * width + iu;
		b->u[0][i] = u - (float)iu;
		b->u[1][i] = v - (float)iv;
	}
	for (int i = 0; i < n; i++) {
		const float *p = map->texel + (long)at[i] * SKULL_CHANNELS, *q = p + (long)width * SKULL_CHANNELS;
		texel_pair top = *(const texel_pair *)p, bottom = *(const texel_pair *)q, both = top + b->u[1][i] * (bottom - top);
		texel_row left = __builtin_shufflevector(both, both, 0, 1, 2, 3, 4, 5, 6, 7);
		texel_row right = __builtin_shufflevector(both, both, 8, 9, 10, 11, 12, 13, 14, 15);
		*(texel_row *)texel[i] = left + b->u[0][i] * (right - left);
	}
	SIMD_LOOP
	for (int i = 0; i < n; i++) {
		b->x[0][i] = texel[i][0] + t->offset[0][i];
		b->x[1][i] = texel[i][1] + t->offset[1][i];
		b->x[2][i] = texel[i][2] + t->offset[2][i];
		if (normals) {
			b->n[0][i] = texel[i][3] + t->lean[0][i];
			b->n[1][i] = texel[i][4] + t->lean[1][i];
			b->n[2][i] = texel[i][5] + t->lean[2][i];
		}
	}
}

/* Whether no vertex is within the globe's reach: algorithm 1 then leaves them, unless they keep their distance from it. */
SIMD_INLINE bool off_globe(const struct block *b, const struct deform_terms_block *t, const struct globe *g, int n)
{
	float least = INFINITY;
#pragma omp simd reduction(min : least)
	for (int i = 0; i < n; i++) {
		float x = b->x[0][i] - g->o[0], y = b->x[1][i] - g->o[1], z = b->x[2][i] - g->o[2], off = (x * x + y * y + z * z) - t->clear[i];
		least = off < least ? off : least;
	}
	return least > 0;
}

SIMD_INLINE void unit_normals(struct block *restrict b, int n)
{
	float *restrict x = b->n[0], *restrict y = b->n[1], *restrict z = b->n[2];
	SIMD_LOOP
	for (int i = 0; i < n; i++) {
		float len = 1 / sqrtf(x[i] * x[i] + y[i] * y[i] + z[i] * z[i] + 1e-30f);
		x[i] *= len;
		y[i] *= len;
		z[i] *= len;
	}
}

/* Vertices relative to the globe: x, y, z and distance from its centre; the cell of the octahedral map in that direction, the place in
 * it, and D at its corners (globe_map_at without branches). */
struct from_globe {
	float x[3][BLOCK], far[BLOCK], u[BLOCK], v[BLOCK], corner[BLOCK][4] __attribute__((aligned(64)));
	int cell[BLOCK];
};

SIMD_INLINE void look_from(struct from_globe *restrict s, const struct block *restrict b, const struct globe *restrict g, int n)
{
	const float *R = g->R, top = (float)g->map->n;
	float ox = g->o[0], oy = g->o[1], oz = g->o[2];
	int nodes = g->map->n + 1;
	SIMD_LOOP
	for (int i = 0; i < n; i++) {
		float x = b->x[0][i] - ox, y = b->x[1][i] - oy, z = b->x[2][i] - oz;
		float rx = R[0] * x + R[1] * y + R[2] * z, ry = R[3] * x + R[4] * y + R[5] * z, rz = R[6] * x + R[7] * y + R[8] * z;
		float ax = rx < 0 ? -rx : rx, ay = ry < 0 ? -ry : ry, az = rz < 0 ? -rz : rz, k = 1 / (ax + ay + az);
		float u = rx * k, v = ry * k, au = ax * k, av = ay * k;
		float fu = (1 - av) * (u < 0 ? -1.0f : 1.0f), fv = (1 - au) * (v < 0 ? -1.0f : 1.0f);
		u = 0.5f * ((rz < 0 ? fu : u) + 1) * top;
		v = 0.5f * ((rz < 0 ? fv : v) + 1) * top;
		u = u < top - 1e-3f ? u : top - 1e-3f;
		v = v < top - 1e-3f ? v : top - 1e-3f;
		int iu = (int)u, iv = (int)v;
		s->x[0][i] = x;
		s->x[1][i] = y;
		s->x[2][i] = z;
		s->far[i] = sqrtf(rx * rx + ry * ry + rz * rz) + 1e-12f;
		s->cell[i] = iv * nodes + iu;
		s->u[i] = u - (float)iu;
		s->v[i] = v - (float)iv;
	}
	for (int i = 0; i < n; i++) {
		const float *map = g->map->radius + s->cell[i];
		memcpy(s->corner[i], map, 2 * sizeof *map);
		memcpy(s->corner[i] + 2, map + nodes, 2 * sizeof *map);
	}
}

/* The rest of algorithm 1: radial displacement and normals (eqs. 3.17 to 3.19). */
SIMD_INLINE void on_globe(struct block *restrict b, const struct deform_terms_block *restrict t, const struct globe *restrict g, int n)
{
	float ox = g->o[0], oy = g->o[1], oz = g->o[2];
	struct from_globe s;
	look_from(&s, b, g, n);
	SIMD_LOOP
	for (int i = 0; i < n; i++) {
		float x = s.x[0][i], y = s.x[1][i], z = s.x[2][i], far = s.far[i], inverse = 1 / far, u = s.u[i], v = s.v[i], w = t->glue[i];
		float D = (1 - v) * ((1 - u) * s.corner[i][0] + u * s.corner[i][1]) + v * ((1 - u) * s.corner[i][2] + u * s.corner[i][3]);
		float out = D + t->thickness[i], pushed = far < out ? out : far, to = pushed + w * (D + t->gap[i] - pushed), k = to * inverse;
		float tx = x * inverse, ty = y * inverse, tz = z * inverse;
		// eq. 3.19: the normal at rest, turned by the smallest rotation from tau0 to tau.
		float ax = t->tau0[0][i], ay = t->tau0[1][i], az = t->tau0[2][i], mx = t->normal0[0][i], my = t->normal0[1][i], mz = t->normal0[2][i];
		float vx = ay * tz - az * ty, vy = az * tx - ax * tz, vz = ax * ty - ay * tx;
		float c = ax * tx + ay * ty + az * tz, q = (vx * mx + vy * my + vz * mz) / (1.000001f + c);
		float hx = c * mx + vy * mz - vz * my + q * vx, hy = c * my + vz * mx - vx * mz + q * vy;
		float hz = c * mz + vx * my - vy * mx + q * vz;
		// eq. 3.17, blended in over a tenth of a millimetre: no crease forms where skin begins to touch the globe.
		float on = 10 * (out - far), nx = b->n[0][i], ny = b->n[1][i], nz = b->n[2][i];
		on = on > 0 ? on : 0;
		on = on < 1 ? on : 1;
		nx += on * (tx - nx);
		ny += on * (ty - ny);
		nz += on * (tz - nz);
		b->n[0][i] = nx + w * (hx - nx);
		b->n[1][i] = ny + w * (hy - ny);
		b->n[2][i] = nz + w * (hz - nz);
		b->x[0][i] = ox + k * x;
		b->x[1][i] = oy + k * y;
		b->x[2][i] = oz + k * z;
	}
}

/* Writes positions or normals to the rows of the mesh. */
SIMD_INLINE void put(float (*out)[3], const float x[3][BLOCK], const struct deform_run *run, int n_runs, int n)
{
	float rows[BLOCK][3];
	const float *restrict a = x[0], *restrict b = x[1], *restrict c = x[2];
	SIMD_LOOP
	for (int i = 0; i < n; i++) {
		rows[i][0] = a[i];
		rows[i][1] = b[i];
		rows[i][2] = c[i];
	}
	for (int r = 0, i = 0; r < n_runs; i += run[r++].n)
		memcpy(out[run[r].vertex], rows[i], (size_t)run[r].n * sizeof *rows);
}

/* Loops over a block run over whole vectors: its entries beyond n repeat the last vertex. */
SIMD_INLINE int whole(int n)
{
	return (n + 15) & ~15;
}

SIMD_CLONES static void pose_skin(const struct deform *d, int k, const float *e, const struct globe *g, float (*xyz)[3], float (*normal)[3])
{
	const struct deform_block *of = &d->block[k];
	const struct deform_terms_block *t = &d->terms[k];
	const struct deform_run *run = d->run + of->run;
	struct block b;
	int n = whole(of->n);
	skin_coordinates(&b, t, e, n, of->lids);
	if (normal)
		on_skull(&b, t, &d->rig->skull, n, true);
	else
		on_skull(&b, t, &d->rig->skull, n, false);
	if (of->glue || !off_globe(&b, t, g, n))
		on_globe(&b, t, g, n);
	put(xyz, b.x, run, of->n_runs, n);
	if (normal) {
		unit_normals(&b, n);
		put(normal, b.n, run, of->n_runs, n);
	}
}

/* x[3] of each vertex, turned and moved. */
SIMD_INLINE void turned(float (*restrict out)[BLOCK], const float (*restrict x)[BLOCK], const float *R, const float *o, int n)
{
	SIMD_LOOP
	for (int i = 0; i < n; i++) {
		out[0][i] = R[0] * x[0][i] + R[1] * x[1][i] + R[2] * x[2][i] + o[0];
		out[1][i] = R[3] * x[0][i] + R[4] * x[1][i] + R[5] * x[2][i] + o[1];
		out[2][i] = R[6] * x[0][i] + R[7] * x[1][i] + R[8] * x[2][i] + o[2];
	}
}

SIMD_CLONES static void turn_globe(const struct deform *d, int k, const float *R, const float *center, float (*xyz)[3], float (*normal)[3])
{
	static const float none[3];
	const struct deform_block *of = &d->globe_block[k];
	const struct deform_run *run = d->run + of->run;
	float out[3][BLOCK];
	int n = whole(of->n);
	turned(out, d->globe[k].x, R, center, n);
	put(xyz, out, run, of->n_runs, n);
	if (normal) {
		turned(out, d->globe[k].normal, R, none, n);
		put(normal, out, run, of->n_runs, n);
	}
}

void deform_pose(const struct deform *d, const double e[RIG_COMPONENTS], const double target_from_globe[2][3][3],
                 float (*xyz)[3], float (*normal)[3])
{
	struct globe globe[2];
	float ef[RIG_COMPONENTS], turn[2][9];
	for (int k = 0; k < RIG_COMPONENTS; k++)
		ef[k] = (float)e[k];
	for (int s = 0; s < 2; s++) {
		double from_rest[3][3];
		mat_mul(from_rest, target_from_globe[s], d->rig->head_from_target);
		globe[s].map = &d->rig->globe[s].map;
		for (int i = 0; i < 3; i++) {
			globe[s].o[i] = (float)d->rig->globe[s].center[i];
			for (int j = 0; j < 3; j++) {
				globe[s].R[3 * i + j] = (float)target_from_globe[s][j][i];
				turn[s][3 * i + j] = (float)from_rest[i][j];
			}
		}
	}
	for (int k = 0; k < d->n_blocks; k++)
		pose_skin(d, k, ef, &globe[d->block[k].side], xyz, normal);
	for (int k = 0; k < d->n_globe_blocks; k++)
		turn_globe(d, k, turn[d->globe_block[k].side], globe[d->globe_block[k].side].o, xyz, normal);
}
