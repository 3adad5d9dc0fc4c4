/* Lights from the environment, carried into the eye. Each is so far away that its direction is one for the whole iris:
 * its refraction function f(P, w) -> K (iris paper, eq. 15) is then a smooth field over the iris, tabulated on two planes
 * of SCENE_GRID^2 points solved exactly (path = grid), or solved for every ray at both ends (path = ends). */
#include "eye/scene_march.h"

#include <math.h>
#include <stdlib.h>

#include "base/mem.h"
#include "math/vec.h"

#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC optimize("no-tree-pre")  // see scene_meet.c
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

/* What a node tells the march: unit direction towards the light, irradiance of a plane that faces it, and where on the
 * cornea it came in, 1 at the limbus. */
static void node_put(float out[SCENE_WAY], const double p[3], const float k[3], float gain, const double limbus[2])
{
	double d[3] = { k[0] - p[0], k[1] - p[1], k[2] - p[2] };
	vec_unit(d, d);
	for (int c = 0; c < 3; c++)
		out[c] = (float)d[c];
	out[3] = (float)(gain / fmax(-d[2], 0.05));
	out[4] = (float)hypot(k[0] / limbus[0], k[1] / limbus[1]);
}

static void plane_points(struct plane *n, const struct scene *s, float z)
{
	double step = 2 * s->extent / (SCENE_GRID - 1), most = 1.04 * s->limbus[0];
	for (int i = 0; i < NODES; i++) {
		// Outside the limbus there is no iris to light: those nodes only bound the others' cells, and stand at its edge.
		double x = i % SCENE_GRID * step - s->extent, y = i / SCENE_GRID * step - s->extent, r = hypot(x, y);
		double pull = r > most ? most / r : 1;
		n->p[0][i] = (float)(pull * x);
		n->p[1][i] = (float)(pull * y);
		n->p[2][i] = z;
	}
}

static void plane_make(float (*way)[SCENE_WAY], struct plane *n, const struct scene_beam *beam, const struct scene *s, float z)
{
	plane_points(n, s, z);
	for (int i = 0; i < NODES; i++)
		for (int c = 0; c < 3; c++)
			n->w[c][i] = beam->dir[c];
	plane_solve(n, s);
	for (int i = 0; i < NODES; i++) {
		bool lit = n->status[i] == LIGHTPATH_OK || n->status[i] == LIGHTPATH_BEYOND_RIM, none = n->status[i] == LIGHTPATH_NONE;
		double p[3] = { n->p[0][i], n->p[1][i], n->p[2][i] };
		float k[3];
		for (int c = 0; c < 3; c++)
			k[c] = none ? n->p[c][i] + beam->dir[c] : n->k[c][i];
		node_put(way[i], p, k, lit && n->gain[i] > 0 && isfinite(n->gain[i]) ? n->gain[i] : 0, s->limbus);
	}
}

static void beam_depths(struct scene_beam *beam, const struct scene *s)
{
	beam->z[0] = (float)(s->eye.iris_depth - s->height_max);
	beam->z[1] = (float)(s->eye.iris_depth - s->height_min + s->optics.abl_thickness) + s->thickness_max;
}

static void beam_make(struct scene_beam *beam, const struct scene *s)
{
	struct plane *plane = mem_array(1, sizeof *plane);
	beam_depths(beam, s);
	for (int k = 0; k < 2; k++)
		plane_make(beam->way[k][0], plane, beam, s, beam->z[k]);
	free(plane);
}

struct scene_beam *scene_sight(const struct scene *s, const double C[3])
{
	struct scene_beam *beam = mem_new(1, sizeof *beam);
	struct plane *plane = mem_array(1, sizeof *plane);
	beam_depths(beam, s);
	for (int k = 0; k < 2; k++) {
		plane_points(plane, s, beam->z[k]);
		lightpath_batch_point(NODES, plane->p[0], plane->p[1], plane->p[2], C, plane->k[0], plane->k[1], plane->k[2], plane->status,
		                      &s->cornea, PATH_STEPS);
		for (int i = 0; i < NODES; i++) {
			bool none = plane->status[i] == LIGHTPATH_NONE;
			double p[3] = { plane->p[0][i], plane->p[1][i], plane->p[2][i] };
			float up[3] = { plane->p[0][i], plane->p[1][i], plane->p[2][i] - 1 };
			float at[3] = { plane->k[0][i], plane->k[1][i], plane->k[2][i] };
			node_put(beam->way[k][i / SCENE_GRID][i % SCENE_GRID], p, none ? up : at, 1, s->limbus);
		}
	}
	free(plane);
	return beam;
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

SIMD_CLONES
void scene_table_at(float out[SCENE_WAY], const struct scene_beam *beam, const float p[3], float extent)
{
	float per = (SCENE_GRID - 1) / (2 * extent), top = SCENE_GRID - 1.001f, u = (p[0] + extent) * per, v = (p[1] + extent) * per;
	float q = (p[2] - beam->z[0]) / (beam->z[1] - beam->z[0]), r = 1 - q;
	u = u > 0 ? u < top ? u : top : 0;
	v = v > 0 ? v < top ? v : top : 0;
	int iu = (int)u, iv = (int)v;
	u -= (float)iu;
	v -= (float)iv;
	const float(*restrict a)[SCENE_WAY] = &beam->way[0][iv][iu], (*restrict b)[SCENE_WAY] = &beam->way[1][iv][iu];
	float w00 = (1 - u) * (1 - v), w10 = u * (1 - v), w01 = (1 - u) * v, w11 = u * v;
	for (int c = 0; c < SCENE_WAY; c++)
		out[c] = r * (w00 * a[0][c] + w10 * a[1][c] + w01 * a[SCENE_GRID][c] + w11 * a[SCENE_GRID + 1][c])
		         + q * (w00 * b[0][c] + w10 * b[1][c] + w01 * b[SCENE_GRID][c] + w11 * b[SCENE_GRID + 1][c]);
}

/* The sclera begins at the limbus, gradually: light that would enter further out is stopped. */
SIMD_CLONES
static void rim_stop(int n, float *restrict power, const float *restrict rho, float width)
{
	float lo = 1 - width / 2, inv = 1 / width;
	SIMD_LOOP
	for (int i = 0; i < n; i++) {
		float t = (rho[i] - lo) * inv;
		t = t > 0 ? t < 1 ? t : 1 : 0;
		power[i] = power[i] > 0 ? power[i] * (1 - t * t * (3 - 2 * t)) : 0;
	}
}

static void table_paths(struct march_light *light, int end, int n, const float *x, const float *y, const float *z,
                        const struct scene_beam *beam, float extent, float width)
{
	float rho[PART];
	for (int i = 0; i < n; i++) {
		float way[SCENE_WAY];
		scene_table_at(way, beam, (float[3]){ x[i], y[i], z[i] }, extent);
		light->x[end][i] = way[0];
		light->y[end][i] = way[1];
		light->z[end][i] = way[2];
		light->power[end][i] = way[2] < 0 ? way[3] : 0;  // an iris that juts out of its cornea is not lit from behind
		rho[i] = way[4];
	}
	rim_stop(n, light->power[end], rho, width);
}

static void exact_paths(struct march_light *light, int end, int n, const float *x, const float *y, const float *z,
                        const struct scene *s, const struct scene_beam *beam)
{
	float w[3][PART], k[3][PART];
	unsigned char status[PART];
	for (int i = 0; i < PART; i++)
		for (int c = 0; c < 3; c++)
			w[c][i] = beam->dir[c];
	lightpath_batch(n, x, y, z, w[0], w[1], w[2], k[0], k[1], k[2], status, &s->cornea, PATH_STEPS);
	for (int i = 0; i < n; i++) {
		if (status[i] != LIGHTPATH_OK && status[i] != LIGHTPATH_BEYOND_RIM)
			continue;
		float d[3] = { k[0][i] - x[i], k[1][i] - y[i], k[2][i] - z[i] }, inv = 1 / sqrtf(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
		if (!(d[2] < 0))
			continue;
		light->x[end][i] = d[0] * inv;
		light->y[end][i] = d[1] * inv;
		light->z[end][i] = d[2] * inv;
	}
}

void scene_light_at(struct march_light *light, int end, int n, const float *x, const float *y, const float *z,
                    const struct scene *s, const struct scene_beam *beam)
{
	// The power is the table's either way: it needs no more.
	table_paths(light, end, n, x, y, z, beam, (float)s->extent, (float)(s->conf.limbus_width / s->limbus[0]));
	if (s->conf.path == SCENE_PATH_ENDS)
		exact_paths(light, end, n, x, y, z, s, beam);
}
