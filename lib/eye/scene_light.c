/* Lights from the environment, carried into the eye. Each is so far away that its direction is one for the whole iris:
 * its refraction function f(P, w) -> K (iris paper, eq. 15) is then a smooth field over the iris, tabulated on two planes
 * of SCENE_GRID^2 points solved exactly (path = grid), or solved for every ray at both ends (path = ends). */
#include "eye/scene_impl.h"

#include <math.h>
#include <stdlib.h>

#include "base/mem.h"
#include "math/vec.h"

#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC optimize("no-tree-pre")  // see scene_march.c
#endif

/* Newton steps from the closed-form start: 2e-5 mm at worst. */
enum { PATH_STEPS = 4 };

struct scene_lighting scene_lighting(const struct envmap *env, const struct envmap *mirror, int lights)
{
	struct scene_lighting l = { .env = env, .mirror = mirror };
	l.n = envmap_lights(l.light, lights, env);
	return l;
}

enum { NODES = SCENE_GRID * SCENE_GRID };

/* One plane of a beam's table. Its nodes are interpolated: they want the one path that goes on smoothly everywhere, the
 * shortest, not a focused one here and there. */
struct plane {
	float p[3][NODES], w[3][NODES], k[3][NODES], gain[NODES];
	unsigned char status[NODES];
};

static void plane_solve(struct plane *n, const struct scene *s)
{
	if (s->refraction.data || s->refraction.steps)
		refraction_batch(&s->refraction, NODES, n->p[0], n->p[1], n->p[2], n->w[0], n->w[1], n->w[2], n->k[0], n->k[1],
		                 n->k[2], 0, n->status);
	else
		lightpath_batch(NODES, n->p[0], n->p[1], n->p[2], n->w[0], n->w[1], n->w[2], n->k[0], n->k[1], n->k[2], n->status,
		                &s->cornea, PATH_STEPS);
	lightpath_gain_batch(NODES, n->p[0], n->p[1], n->p[2], n->w[0], n->w[1], n->w[2], n->k[0], n->k[1], n->k[2], n->gain,
	                     &s->cornea);
}

static void plane_make(float (*K)[4], struct plane *n, const struct scene_beam *beam, const struct scene *s, float z)
{
	double step = 2 * s->extent / (SCENE_GRID - 1), most = 1.04 * s->limbus[0];
	for (int i = 0; i < NODES; i++) {
		// Outside the limbus there is no iris to light: those nodes only bound the others' cells, and stand at its edge.
		double x = i % SCENE_GRID * step - s->extent, y = i / SCENE_GRID * step - s->extent, r = hypot(x, y);
		double pull = r > most ? most / r : 1;
		n->p[0][i] = (float)(pull * x);
		n->p[1][i] = (float)(pull * y);
		n->p[2][i] = z;
		for (int c = 0; c < 3; c++)
			n->w[c][i] = beam->dir[c];
	}
	plane_solve(n, s);
	for (int i = 0; i < NODES; i++) {
		bool lit = n->status[i] == LIGHTPATH_OK || n->status[i] == LIGHTPATH_BEYOND_RIM;
		for (int c = 0; c < 3; c++)
			K[i][c] = n->status[i] == LIGHTPATH_NONE ? n->p[c][i] + beam->dir[c] : n->k[c][i];
		K[i][3] = lit && n->gain[i] > 0 && isfinite(n->gain[i]) ? n->gain[i] : 0;
	}
}

static void beam_make(struct scene_beam *beam, const struct scene *s)
{
	struct plane *plane = mem_array(1, sizeof *plane);
	beam->z[0] = (float)(s->eye.iris_depth - s->height_max);
	beam->z[1] = (float)(s->eye.iris_depth - s->height_min + s->optics.abl_thickness) + s->thickness_max;
	for (int k = 0; k < 2; k++)
		plane_make(beam->K[k][0], plane, beam, s, beam->z[k]);
	free(plane);
}

struct scene_beams scene_beams(const struct scene *s, const struct scene_lighting *light,
                               const double eye_from_cam[3][3])
{
	struct scene_beams beams = { 0, mem_array((size_t)light->n, sizeof(struct scene_beam)) };
	for (int i = 0; i < light->n; i++) {
		const struct envmap_light *l = &light->light[i];
		double d[3] = { l->dir[0], l->dir[1], l->dir[2] };
		mat_vec(d, eye_from_cam, d);
		if (d[2] > 0.16)  // further than about 99 degrees from the axis: no path leads into the eye (ANCHORS: 98.8)
			continue;
		struct scene_beam *beam = &beams.beam[beams.n++];
		for (int c = 0; c < 3; c++) {
			beam->dir[c] = (float)d[c];
			beam->rgb[c] = l->rgb[c];
		}
	}
#pragma omp parallel for schedule(dynamic)
	for (int i = 0; i < beams.n; i++)
		beam_make(&beams.beam[i], s);
	return beams;
}

SIMD_INLINE float blend(const float *k, int at, float a, float b, float c, float d)
{
	return a * k[at] + b * k[at + 4] + c * k[at + 4 * SCENE_GRID] + d * k[at + 4 * SCENE_GRID + 4];
}

SIMD_CLONES
static void grid_paths(float K[4][BATCH], const struct iris_batch *b, const float *restrict t,
                       const struct scene_beam *beam, float extent)
{
	const float *restrict k0 = &beam->K[0][0][0][0], *restrict k1 = &beam->K[1][0][0][0];
	const float *restrict px = b->px, *restrict py = b->py, *restrict pz = b->pz;
	const float *restrict vx = b->vx, *restrict vy = b->vy, *restrict vz = b->vz;
	float *restrict x = K[0], *restrict y = K[1], *restrict z = K[2], *restrict gain = K[3];
	float per = (SCENE_GRID - 1) / (2 * extent), z0 = beam->z[0], inv = 1 / (beam->z[1] - z0), top = SCENE_GRID - 1.001f;
	SIMD_LOOP
	for (int i = 0; i < b->n; i++) {
		float u = (px[i] + t[i] * vx[i] + extent) * per, v = (py[i] + t[i] * vy[i] + extent) * per;
		float q = (pz[i] + t[i] * vz[i] - z0) * inv;
		u = u > 0 ? u < top ? u : top : 0;
		v = v > 0 ? v < top ? v : top : 0;
		int iu = (int)u, iv = (int)v, at = 4 * (iv * SCENE_GRID + iu);
		u -= (float)iu;
		v -= (float)iv;
		float a = (1 - u) * (1 - v), e = u * (1 - v), f = (1 - u) * v, g = u * v;
		x[i] = blend(k0, at, a, e, f, g) * (1 - q) + blend(k1, at, a, e, f, g) * q;
		y[i] = blend(k0, at + 1, a, e, f, g) * (1 - q) + blend(k1, at + 1, a, e, f, g) * q;
		z[i] = blend(k0, at + 2, a, e, f, g) * (1 - q) + blend(k1, at + 2, a, e, f, g) * q;
		gain[i] = blend(k0, at + 3, a, e, f, g) * (1 - q) + blend(k1, at + 3, a, e, f, g) * q;
	}
}

/* The sclera begins at the limbus, gradually: light that would enter further out is stopped. */
SIMD_CLONES
static void rim_stop(float K[4][BATCH], int n, float ax, float ay, float width)
{
	const float *restrict kx = K[0], *restrict ky = K[1];
	float *restrict gain = K[3], lo = 1 - width / 2, inv = 1 / width;
	SIMD_LOOP
	for (int i = 0; i < n; i++) {
		float r = sqrtf(kx[i] * kx[i] * ax * ax + ky[i] * ky[i] * ay * ay), t = (r - lo) * inv;
		t = t > 0 ? t < 1 ? t : 1 : 0;
		gain[i] = gain[i] > 0 ? gain[i] * (1 - t * t * (3 - 2 * t)) : 0;
	}
}

static void exact_paths(float K[4][BATCH], const struct iris_batch *b, const float t[BATCH], const struct scene *s,
                        const struct scene_beam *beam)
{
	float x[BATCH], y[BATCH], z[BATCH], w[3][BATCH];
	for (int i = 0; i < b->n; i++) {
		x[i] = b->px[i] + t[i] * b->vx[i];
		y[i] = b->py[i] + t[i] * b->vy[i];
		z[i] = b->pz[i] + t[i] * b->vz[i];
		for (int c = 0; c < 3; c++)
			w[c][i] = beam->dir[c];
	}
	float k[3][BATCH];
	unsigned char status[BATCH];
	lightpath_batch(b->n, x, y, z, w[0], w[1], w[2], k[0], k[1], k[2], status, &s->cornea, PATH_STEPS);
	for (int i = 0; i < b->n; i++)
		if (status[i] == LIGHTPATH_OK || status[i] == LIGHTPATH_BEYOND_RIM)
			for (int c = 0; c < 3; c++)
				K[c][i] = k[c][i];
}

void scene_beam_paths(float K[4][BATCH], const struct iris_batch *b, const float t[BATCH], const struct scene *s,
                      const struct scene_beam *beam)
{
	grid_paths(K, b, t, beam, (float)s->extent);  // the gain is the grid's either way: it needs no more
	if (s->conf.path == SCENE_PATH_ENDS)
		exact_paths(K, b, t, s, beam);
	rim_stop(K, b->n, (float)(1 / s->limbus[0]), (float)(1 / s->limbus[1]), (float)(s->conf.limbus_width / s->limbus[0]));
}
