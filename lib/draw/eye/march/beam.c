/* Lights of the environment refracted into the eye. Each is so far away that its direction is the same for the whole iris: its
 * refraction function f(P, w) -> K (iris paper, eq. 15) is a smooth field over the iris, tabulated on two planes of SCENE_GRID^2
 * points that are solved exactly. Neighbouring lights share a table: behind the cornea, which compresses the whole sky into 48
 * degrees, they differ little. The table keeps their summed power and their mean direction, whose length is less than 1: the
 * irradiance of any plane is exactly their sum, and lights below the eye's horizon contribute nothing. */
#include "draw/eye/march/beam.h"

#include <math.h>
#include <stdlib.h>

#include "base/mem.h"
#include "draw/eye/make.h"
#include "draw/eye/march/beside.h"
#include "draw/eye/march/paths.h"
#include "draw/eye/own_light.h"
#include "math/vec.h"
#include "optics/lightpath/lightpath.h"

#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC optimize("no-tree-pre", "fp-contract=fast")  // see meet.c, simd.h
#endif

enum { NODES = SCENE_GRID * SCENE_GRID };

/* One plane of a beam's table. Its nodes are interpolated, so they take the one path that is smooth everywhere, the shortest, not a
 * focused one here and there. */
struct plane {
	int side, n;  // nodes across, and all
	float p[3][NODES], w[3][NODES], k[3][NODES], gain[NODES];
	unsigned char status[NODES];
};

static void plane_solve(struct plane *n, const struct scene *s)
{
	if (s->refraction.data || s->refraction.steps)
		refraction_batch(&s->refraction, n->n, n->p[0], n->p[1], n->p[2], n->w[0], n->w[1], n->w[2], n->k[0], n->k[1],
		                 n->k[2], 0, n->status);
	else
		lightpath_batch(n->n, n->p[0], n->p[1], n->p[2], n->w[0], n->w[1], n->w[2], n->k[0], n->k[1], n->k[2], n->status,
		                &s->cornea, SCENE_PATH_STEPS);
	lightpath_gain_batch(n->n, n->p[0], n->p[1], n->p[2], n->w[0], n->w[1], n->w[2], n->k[0], n->k[1], n->k[2], n->gain,
	                     &s->cornea);
}

/* Fills the channels of a node (beam.h). p: the point; k: where its path enters the cornea. */
static void node_put(float out[SCENE_WAY], const double p[3], const float k[3], float gain, const double limbus[2])
{
	double d[3] = { k[0] - p[0], k[1] - p[1], k[2] - p[2] };
	vec_unit(d, d);
	for (int c = 0; c < 3; c++)
		out[c] = (float)d[c];
	out[3] = (float)(gain / fmax(-d[2], 0.05));
	out[4] = (float)hypot(k[0] / limbus[0], k[1] / limbus[1]);
	out[5] = (float)-d[2];
}

static void plane_points(struct plane *n, int side, const struct scene *s, float z)
{
	double step = 2 * s->extent / (side - 1), most = 1.04 * s->limbus[0];
	n->side = side;
	n->n = side * side;
	for (int i = 0; i < n->n; i++) {
		// Outside the limbus there is no iris: those nodes only bound the cells of others, and are placed at its edge.
		double x = i % side * step - s->extent, y = i / side * step - s->extent, r = hypot(x, y);
		double pull = r > most ? most / r : 1;
		n->p[0][i] = (float)(pull * x);
		n->p[1][i] = (float)(pull * y);
		n->p[2][i] = z;
	}
}

/* Sums over the lights of a beam at a plane's nodes: power, power times direction, power times direction times cosine, power
 * times the place of entry on the cornea (scene_beam_direction). */
struct plane_sum {
	float power[NODES], dir[3][NODES], down[3][NODES], rho[NODES];
};

struct plane_work {
	struct plane plane;
	struct plane_sum sum;
};

SIMD_CLONES static void plane_add(struct plane_sum *sum, const struct plane *n, const float *restrict lit, const float dir[3], float share, const double limbus[2])
{
	float per_x = (float)(1 / limbus[0]), per_y = (float)(1 / limbus[1]);
	SIMD_LOOP
	for (int i = 0; i < n->n; i++) {
		float none = lit[i] < 0 ? 1.0f : 0.0f, gain = lit[i] > 0 ? n->gain[i] : 0;
		float dx = none > 0 ? dir[0] : n->k[0][i] - n->p[0][i], dy = none > 0 ? dir[1] : n->k[1][i] - n->p[1][i], dz = none > 0 ? dir[2] : n->k[2][i] - n->p[2][i];
		float inv = 1 / sqrtf(dx * dx + dy * dy + dz * dz), down = -dz * inv, x = (n->p[0][i] + dx) * per_x, y = (n->p[1][i] + dy) * per_y;
		gain = gain > 0 && gain < 1e6f ? gain : 0;
		float power = share * (gain / (down > 0.05f ? down : 0.05f) + 1e-9f);  // where none comes, a direction still
		sum->power[i] += power;
		sum->dir[0][i] += power * inv * dx;
		sum->dir[1][i] += power * inv * dy;
		sum->dir[2][i] += power * inv * dz;
		sum->rho[i] += power * sqrtf(x * x + y * y);
		power *= inv * down;
		sum->down[0][i] += power * dx;
		sum->down[1][i] += power * dy;
		sum->down[2][i] += power * dz;
	}
}

static void cubic(float w[4], int *at, int i)
{
	float x = (float)i * (SCENE_COARSE - 1) / (SCENE_GRID - 1);
	*at = (int)x < SCENE_COARSE - 3 ? (int)x > 1 ? (int)x - 1 : 0 : SCENE_COARSE - 4;
	float t = x - (float)(*at + 1), u = t * t;
	if (t < 0 || t > 1) {  // at the border: linear
		int k = t < 0 ? 0 : 2;
		w[0] = w[1] = w[2] = w[3] = 0;
		w[k] = (float)(k - 1) + 1 - t;
		w[k + 1] = 1 - w[k];
		return;
	}
	w[0] = 0.5f * (2 * u - t - t * u);
	w[1] = 0.5f * (2 - 5 * u + 3 * t * u);
	w[2] = 0.5f * (t + 4 * u - 3 * t * u);
	w[3] = 0.5f * (t * u - u);
}

SIMD_CLONES static void refine(float (*restrict way)[SCENE_WAY], const float (*restrict coarse)[SCENE_WAY])
{
	float w[SCENE_GRID][4], row[SCENE_GRID][SCENE_COARSE][SCENE_WAY];
	int at[SCENE_GRID];
	for (int i = 0; i < SCENE_GRID; i++)
		cubic(w[i], &at[i], i);
	for (int y = 0; y < SCENE_GRID; y++)
		for (int x = 0; x < SCENE_COARSE; x++)
			for (int c = 0; c < SCENE_WAY; c++)
				row[y][x][c] = w[y][0] * coarse[at[y] * SCENE_COARSE + x][c] + w[y][1] * coarse[(at[y] + 1) * SCENE_COARSE + x][c]
				               + w[y][2] * coarse[(at[y] + 2) * SCENE_COARSE + x][c] + w[y][3] * coarse[(at[y] + 3) * SCENE_COARSE + x][c];
	for (int y = 0; y < SCENE_GRID; y++)
		for (int x = 0; x < SCENE_GRID; x++)
			for (int c = 0; c < SCENE_WAY; c++)
				way[y * SCENE_GRID + x][c] = w[x][0] * row[y][at[x]][c] + w[x][1] * row[y][at[x] + 1][c] + w[x][2] * row[y][at[x] + 2][c] + w[x][3] * row[y][at[x] + 3][c];
}

/* dir, share: the lights' directions and their shares of the beam. */
static void plane_make(float (*way)[SCENE_WAY], struct plane_work *work, int lights, const float (*dir)[3], const float *share,
                       const struct scene *s, float z)
{
	struct plane *n = &work->plane;
	struct plane_sum *sum = &work->sum;
	float lit[NODES], coarse[SCENE_COARSE * SCENE_COARSE][SCENE_WAY], (*to)[SCENE_WAY] = lights > 1 ? coarse : way;
	plane_points(n, lights > 1 ? SCENE_COARSE : SCENE_GRID, s, z);
	*sum = (struct plane_sum){ 0 };
	for (int l = 0; l < lights; l++) {
		for (int c = 0; c < 3; c++)
			for (int i = 0; i < n->n; i++)
				n->w[c][i] = dir[l][c];
		plane_solve(n, s);
		for (int i = 0; i < n->n; i++)
			lit[i] = n->status[i] == LIGHTPATH_NONE ? -1 : n->status[i] == LIGHTPATH_OK || n->status[i] == LIGHTPATH_BEYOND_RIM;
		plane_add(sum, n, lit, dir[l], share[l], s->limbus);
	}
	for (int i = 0; i < n->n; i++) {
		float node[SCENE_WAY] = { [3] = sum->power[i], [4] = sum->rho[i] / sum->power[i] };
		scene_beam_direction(node, sum->power[i], (float[3]){ sum->dir[0][i], sum->dir[1][i], sum->dir[2][i] },
		                     (float[3]){ sum->down[0][i], sum->down[1][i], sum->down[2][i] });
		for (int c = 0; c < SCENE_WAY; c++)
			to[i][c] = node[c];
	}
	if (lights > 1)
		refine(way, (const float(*)[SCENE_WAY])coarse);
}

static void beam_depths(struct scene_beam *beam, const struct scene *s)
{
	double z[2];
	scene_planes(z, s);
	beam->z[0] = (float)z[0];
	beam->z[1] = (float)z[1];
}

/* Sets a beam's colour and mean direction, and makes its lights' shares sum to 1. */
static void beam_begin(struct scene_beam *beam, struct beam_lights *in, const struct scene *s)
{
	float all = 0;
	*beam = (struct scene_beam){ 0 };
	beam_depths(beam, s);
	for (int i = 0; i < in->n; i++) {
		all += in->share[i];
		for (int c = 0; c < 3; c++) {
			beam->rgb[c] += in->rgb[i][c];
			beam->dir[c] += in->share[i] * in->dir[i][c];
		}
	}
	for (int i = 0; i < in->n; i++)
		in->share[i] /= all;
	for (int c = 0; c < 3; c++)
		beam->dir[c] /= all;
}

static void mean_of(float mean[3], const struct beam_lights *in)
{
	float all = 0;
	mean[0] = mean[1] = mean[2] = 0;
	for (int i = 0; i < in->n; i++) {
		all += in->share[i];
		for (int c = 0; c < 3; c++)
			mean[c] += in->share[i] * in->dir[i][c];
	}
	for (int c = 0; c < 3; c++)
		mean[c] /= all > 0 ? all : 1;
}

struct scene_beams scene_beams(const struct scene *s, const struct scene_lighting *light,
                               const double eye_from_cam[3][3])
{
	int each = light->each > 1 && s->conf.path == SCENE_PATH_GRID ? light->each : 1, most = (light->n + each - 1) / each;
	struct scene_beams beams = { .beam = mem_array((size_t)most, sizeof(struct scene_beam)) };
	struct beam_lights *in = mem_array((size_t)most, sizeof *in);
	scene_lights_turn(in, light, eye_from_cam);
	mean_of(beams.mean, in);
	beams.own = scene_own_light_share(s, beams.mean);
	beams.n = scene_lights_split(in, most);
	for (int i = 0; i < beams.n; i++)
		beam_begin(&beams.beam[i], &in[i], s);
#pragma omp parallel for schedule(dynamic)
	for (int i = 0; i < 2 * beams.n; i++) {
		struct scene_beam *b = &beams.beam[i / 2];
		float(*way)[SCENE_WAY] = b->way[i % 2][0];
		if (s->paths && in[i / 2].n > 1) {
			float coarse[SCENE_COARSE * SCENE_COARSE][SCENE_WAY];
			scene_paths_beam(coarse, s, i % 2, &in[i / 2]);
			refine(way, (const float(*)[SCENE_WAY])coarse);
		} else {
			struct plane_work *work = mem_array(1, sizeof *work);
			plane_make(way, work, in[i / 2].n, in[i / 2].dir, in[i / 2].share, s, b->z[i % 2]);
			free(work);
		}
		for (int k = 0; k < NODES; k++)
			way[k][3] = way[k][3] > 1e-7f ? way[k][3] : 0;
	}
	free(in);
	beams.beside = scene_beside(s, &beams);
	return beams;
}

void scene_beams_free(struct scene_beams *beams)
{
	free(beams->beam);
	free(beams->beside);
	*beams = (struct scene_beams){ 0 };
}

struct scene_beam *scene_sight(const struct scene *s, const double C[3])
{
	struct scene_beam *beam = mem_new(1, sizeof *beam);
	beam_depths(beam, s);
#pragma omp parallel for
	for (int k = 0; k < 2; k++) {
		struct plane *plane = mem_array(1, sizeof *plane);
		plane_points(plane, SCENE_GRID, s, beam->z[k]);
		lightpath_batch_point(NODES, plane->p[0], plane->p[1], plane->p[2], C, plane->k[0], plane->k[1], plane->k[2], plane->status,
		                      &s->cornea, SCENE_PATH_STEPS);
		for (int i = 0; i < NODES; i++) {
			bool none = plane->status[i] == LIGHTPATH_NONE;
			double p[3] = { plane->p[0][i], plane->p[1][i], plane->p[2][i] };
			float up[3] = { plane->p[0][i], plane->p[1][i], plane->p[2][i] - 1 };
			float at[3] = { plane->k[0][i], plane->k[1][i], plane->k[2][i] };
			node_put(beam->way[k][i / SCENE_GRID][i % SCENE_GRID], p, none ? up : at, 1, s->limbus);
		}
		free(plane);
	}
	return beam;
}
