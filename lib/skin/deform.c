#include "skin/deform.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "math/simd.h"
#include "math/vec.h"
#include "skin/deform_terms.h"

enum { BLOCK = 256 };

typedef float texel_row __attribute__((vector_size(32), aligned(32)));
_Static_assert(RIG_COMPONENTS % 4 == 0, "components are added in fours");
_Static_assert(sizeof(texel_row) == SKULL_CHANNELS * sizeof(float), "a texel is one vector");

/* The moving vertices, one array for each number, in whole blocks: the last one's rest repeats the last vertex. */
struct deform {
	const struct rig *rig;
	int n, n_blocks, n_globe;
	int *vertex, *globe_vertex;        // rows of the mesh
	float *mean[2], *basis[RIG_BASIS];     // u = mean + basis e
	float *offset[3], *lean[3];        // rest less the skull map there: position, normal
	float *thickness, *gap, *glue, *side;
	float *normal0[3], *tau0[3];       // at rest: normal; unit direction from the globe's centre
	float *map;                        // D of both globes, one behind the other
	int map_n;
};

static float **columns(struct deform *d, int k)
{
	float **all[] = { &d->mean[0],    &d->mean[1],    &d->offset[0],  &d->offset[1], &d->offset[2], &d->lean[0],  &d->lean[1],
		              &d->lean[2],    &d->thickness,  &d->gap,        &d->glue,      &d->side,      &d->normal0[0], &d->normal0[1],
		              &d->normal0[2], &d->tau0[0],    &d->tau0[1],    &d->tau0[2] };
	return k < COUNT(all) ? all[k] : k < COUNT(all) + RIG_BASIS ? &d->basis[k - COUNT(all)] : 0;
}

static void take_vertex(struct deform *d, int k, int i)
{
	const struct rig *rig = d->rig;
	struct deform_terms t;
	deform_terms_of(&t, rig, i);
	for (int c = 0; c < 3; c++) {
		d->offset[c][k] = t.offset[c];
		d->lean[c][k] = t.lean[c];
		d->normal0[c][k] = rig->normal[i][c];
		d->tau0[c][k] = t.tau0[c];
	}
	for (int c = 0; c < 2; c++)
		d->mean[c][k] = t.mean[c];
	for (int j = 0; j < RIG_BASIS; j++)
		d->basis[j][k] = t.basis[j];
	d->thickness[k] = rig->thickness[i];
	d->gap[k] = rig->gap[i];
	d->glue[k] = rig->glue[i];
	d->side[k] = rig->side[i];
}

static void take_maps(struct deform *d)
{
	int n = d->rig->globe[0].map.n, size = (n + 1) * (n + 1);
	d->map_n = n;
	d->map = mem_array(2 * (size_t)size, sizeof *d->map);
	for (int s = 0; s < 2; s++)
		memcpy(d->map + s * size, d->rig->globe[s].map.radius, (size_t)size * sizeof *d->map);
}

struct deform *deform_new(const struct rig *rig)
{
	struct deform *d = mem_new(1, sizeof *d);
	d->rig = rig;
	d->vertex = mem_new((size_t)rig->n + BLOCK, sizeof *d->vertex);
	d->globe_vertex = mem_new((size_t)rig->n + 1, sizeof *d->globe_vertex);
	for (int i = 0; i < rig->n; i++)
		if (rig_is_globe(rig->part[i]))
			d->globe_vertex[d->n_globe++] = i;
		else if (deform_terms_moves(rig, i))
			d->vertex[d->n++] = i;
	d->n_blocks = (d->n + BLOCK - 1) / BLOCK;
	for (int k = 0; columns(d, k); k++)
		*columns(d, k) = mem_array((size_t)d->n_blocks * BLOCK + 1, sizeof(float));
	for (int k = 0; k < d->n_blocks * BLOCK; k++)
		take_vertex(d, k, d->vertex[k < d->n ? k : d->n - 1]);
	take_maps(d);
	return d;
}

void deform_free(struct deform *d)
{
	if (!d)
		return;
	for (int k = 0; columns(d, k); k++)
		free(*columns(d, k));
	free(d->vertex);
	free(d->globe_vertex);
	free(d->map);
	free(d);
}

int deform_moving(const struct deform *d)
{
	return d->n + d->n_globe;
}

void deform_rest(const struct deform *d, float (*xyz)[3], float (*normal)[3])
{
	memcpy(xyz, d->rig->rest, (size_t)d->rig->n * sizeof *xyz);
	if (normal)
		memcpy(normal, d->rig->normal, (size_t)d->rig->n * sizeof *normal);
}

/* A block on its way. */
struct block {
	float u[2][BLOCK], x[3][BLOCK], n[3][BLOCK];
};

SIMD_CLONES
static void skin_coordinates(struct block *restrict b, const struct deform *d, int at, const float e[RIG_COMPONENTS])
{
	for (int c = 0; c < 2; c++) {
		memcpy(b->u[c], d->mean[c] + at, sizeof b->u[c]);
		for (int k = 0; k < RIG_COMPONENTS; k += 4) {
			float *const *basis = d->basis + c * RIG_COMPONENTS + k;
			const float *restrict p = basis[0] + at, *restrict q = basis[1] + at, *restrict r = basis[2] + at, *restrict s = basis[3] + at;
			SIMD_LOOP
			for (int i = 0; i < BLOCK; i++)
				b->u[c][i] += (p[i] * e[k] + q[i] * e[k + 1]) + (r[i] * e[k + 2] + s[i] * e[k + 3]);
		}
	}
}

/* Equations 3.15 and 3.16: four texels a vertex, each one vector of position and normal. */
SIMD_CLONES
static void on_skull(struct block *restrict b, const struct deform *d, int at)
{
	const struct skull_map *map = &d->rig->skull;
	float k = 1 / (float)map->step, x0 = (float)map->x0, y0 = (float)map->y0;
	float right = (float)map->width - 1.001f, low = (float)map->height - 1.001f;
	for (int i = 0; i < BLOCK; i++) {
		float u = (b->u[0][i] - x0) * k, v = (b->u[1][i] - y0) * k;
		u = u > 0 ? u < right ? u : right : 0;
		v = v > 0 ? v < low ? v : low : 0;
		int iu = (int)u, iv = (int)v;
		const texel_row *p = (const texel_row *)map->texel + (long)iv * map->width + iu, *q = p + map->width;
		u -= (float)iu;
		v -= (float)iv;
		texel_row top = p[0] + u * (p[1] - p[0]), bottom = q[0] + u * (q[1] - q[0]);
		texel_row t = top + v * (bottom - top);
		for (int c = 0; c < 3; c++) {
			b->x[c][i] = t[c] + d->offset[c][at + i];
			b->n[c][i] = t[c + 3] + d->lean[c][at + i];
		}
	}
}

/* Both globes as one loop sees them: rotation rows of globe_from_target, centre. */
struct globes {
	float R[2][9], o[2][3];
};

/* D by the octahedron: globe_map_at without branches. */
SIMD_INLINE float radius_at(const float *restrict map, int n, int first, float x, float y, float z)
{
	float ax = x < 0 ? -x : x, ay = y < 0 ? -y : y, az = z < 0 ? -z : z, k = 1 / (ax + ay + az), top = (float)n;
	float u = x * k, v = y * k, au = ax * k, av = ay * k;
	float fu = (1 - av) * (u < 0 ? -1.0f : 1.0f), fv = (1 - au) * (v < 0 ? -1.0f : 1.0f);
	u = 0.5f * ((z < 0 ? fu : u) + 1) * top;
	v = 0.5f * ((z < 0 ? fv : v) + 1) * top;
	u = u < top - 1e-3f ? u : top - 1e-3f;
	v = v < top - 1e-3f ? v : top - 1e-3f;
	int iu = (int)u, iv = (int)v, at = first + iv * (n + 1) + iu;
	u -= (float)iu;
	v -= (float)iv;
	float a = map[at], b = map[at + 1], c = map[at + n + 1], e = map[at + n + 2];
	return (1 - v) * ((1 - u) * a + u * b) + v * ((1 - u) * c + u * e);
}

/* The rest of algorithm 1: radial displacement and normals (eqs. 3.17 to 3.19). */
SIMD_CLONES
static void on_globe(struct block *restrict b, const struct deform *d, int at, const struct globes *g)
{
	const float *restrict map = d->map, *restrict side = d->side + at, *restrict glue = d->glue + at;
	const float *restrict gap = d->gap + at, *restrict thick = d->thickness + at;
	const float *restrict ax = d->tau0[0] + at, *restrict ay = d->tau0[1] + at, *restrict az = d->tau0[2] + at;
	const float *restrict mx = d->normal0[0] + at, *restrict my = d->normal0[1] + at, *restrict mz = d->normal0[2] + at;
	const float *L = g->R[0], *R = g->R[1];
	int n = d->map_n, size = (n + 1) * (n + 1);
	SIMD_LOOP
	for (int i = 0; i < BLOCK; i++) {
		float s = side[i], l = 1 - s;
		float ox = l * g->o[0][0] + s * g->o[1][0], oy = l * g->o[0][1] + s * g->o[1][1], oz = l * g->o[0][2] + s * g->o[1][2];
		float x = b->x[0][i] - ox, y = b->x[1][i] - oy, z = b->x[2][i] - oz;
		float rx = (l * L[0] + s * R[0]) * x + (l * L[1] + s * R[1]) * y + (l * L[2] + s * R[2]) * z;
		float ry = (l * L[3] + s * R[3]) * x + (l * L[4] + s * R[4]) * y + (l * L[5] + s * R[5]) * z;
		float rz = (l * L[6] + s * R[6]) * x + (l * L[7] + s * R[7]) * y + (l * L[8] + s * R[8]) * z;
		float far = sqrtf(rx * rx + ry * ry + rz * rz) + 1e-12f, w = glue[i];
		float D = radius_at(map, n, (int)s * size, rx, ry, rz);
		float out = D + thick[i], pushed = far < out ? out : far, to = pushed + w * (D + gap[i] - pushed), k = to / far;
		float tx = x / far, ty = y / far, tz = z / far;
		// eq. 3.19: the rest's normal, turned by the smallest rotation from tau0 to tau.
		float vx = ay[i] * tz - az[i] * ty, vy = az[i] * tx - ax[i] * tz, vz = ax[i] * ty - ay[i] * tx;
		float c = ax[i] * tx + ay[i] * ty + az[i] * tz, q = (vx * mx[i] + vy * my[i] + vz * mz[i]) / (1.000001f + c);
		float hx = c * mx[i] + vy * mz[i] - vz * my[i] + q * vx, hy = c * my[i] + vz * mx[i] - vx * mz[i] + q * vy;
		float hz = c * mz[i] + vx * my[i] - vy * mx[i] + q * vz;
		// eq. 3.17, over a tenth of a millimetre: no crease stands where skin comes to lie on the globe.
		float on = 10 * (out - far), nx = b->n[0][i], ny = b->n[1][i], nz = b->n[2][i];
		on = on > 0 ? on < 1 ? on : 1 : 0;
		nx += on * (tx - nx);
		ny += on * (ty - ny);
		nz += on * (tz - nz);
		nx += w * (hx - nx);
		ny += w * (hy - ny);
		nz += w * (hz - nz);
		float len = 1 / sqrtf(nx * nx + ny * ny + nz * nz + 1e-30f);
		b->n[0][i] = nx * len;
		b->n[1][i] = ny * len;
		b->n[2][i] = nz * len;
		b->x[0][i] = ox + k * x;
		b->x[1][i] = oy + k * y;
		b->x[2][i] = oz + k * z;
	}
}

static void put(const struct deform *d, const struct block *b, int at, float (*xyz)[3], float (*normal)[3])
{
	int n = d->n - at < BLOCK ? d->n - at : BLOCK;
	for (int i = 0; i < n; i++) {
		int v = d->vertex[at + i];
		for (int c = 0; c < 3; c++)
			xyz[v][c] = b->x[c][i];
		for (int c = 0; normal && c < 3; c++)
			normal[v][c] = b->n[c][i];
	}
}

static void turn_globes(const struct deform *d, const double target_from_globe[2][3][3], float (*xyz)[3], float (*normal)[3])
{
	double turn[2][3][3];
	for (int s = 0; s < 2; s++)
		mat_mul(turn[s], target_from_globe[s], d->rig->head_from_target);
	for (int k = 0; k < d->n_globe; k++) {
		int v = d->globe_vertex[k], s = d->rig->part[v] == RIG_GLOBE_RIGHT;
		const double *o = d->rig->globe[s].center;
		double x[3], n[3];
		for (int c = 0; c < 3; c++) {
			x[c] = d->rig->rest[v][c] - o[c];
			n[c] = d->rig->normal[v][c];
		}
		mat_vec(x, (const double(*)[3])turn[s], x);
		mat_vec(n, (const double(*)[3])turn[s], n);
		for (int c = 0; c < 3; c++) {
			xyz[v][c] = (float)(o[c] + x[c]);
			if (normal)
				normal[v][c] = (float)n[c];
		}
	}
}

void deform_pose(const struct deform *d, const double e[RIG_COMPONENTS], const double target_from_globe[2][3][3],
                 float (*xyz)[3], float (*normal)[3])
{
	struct globes g;
	struct block b;
	float ef[RIG_COMPONENTS];
	for (int k = 0; k < RIG_COMPONENTS; k++)
		ef[k] = (float)e[k];
	for (int s = 0; s < 2; s++)
		for (int i = 0; i < 3; i++) {
			g.o[s][i] = (float)d->rig->globe[s].center[i];
			for (int j = 0; j < 3; j++)
				g.R[s][3 * i + j] = (float)target_from_globe[s][j][i];
		}
	for (int at = 0; at < d->n; at += BLOCK) {
		skin_coordinates(&b, d, at, ef);
		on_skull(&b, d, at);
		on_globe(&b, d, at, &g);
		put(d, &b, at, xyz, normal);
	}
	turn_globes(d, target_from_globe, xyz, normal);
}
