/* Fields of refracted paths on two planes across the iris, tabulated over the light's angle from the axis, for a light at azimuth
 * 0: nodes on rings about the axis. A light between two angles and at any azimuth is interpolated by cubics (Catmull-Rom); all
 * nodes of the field share the weights. */
#include "draw/eye/march/paths_impl.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "draw/eye/make.h"
#include "math/vec.h"
#include "optics/lightpath/lightpath.h"

#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC optimize("no-tree-pre", "fp-contract=fast")  // see meet.c, simd.h
#endif

static const double lowest = 0.16;  // z of the last angle's light: see scene_lights_turn

static void cubic(float w[4], float t)
{
	float u = t * t;
	w[0] = 0.5f * (2 * u - t - t * u);
	w[1] = 0.5f * (2 - 5 * u + 3 * t * u);
	w[2] = 0.5f * (t + 4 * u - 3 * t * u);
	w[3] = 0.5f * (t * u - u);
}

/* The four of n samples about x (in samples), and their weights; linear in the outermost steps. Returns the first. */
static int cubic_of(float w[4], float x, int n)
{
	int at = (int)x < n - 3 ? (int)x > 1 ? (int)x - 1 : 0 : n - 4;
	float t = x - (float)(at + 1);
	if (t >= 0 && t <= 1) {
		cubic(w, t);
		return at;
	}
	int k = t < 0 ? 0 : 2;
	w[0] = w[1] = w[2] = w[3] = 0;
	w[k] = (float)(k - 1) + 1 - t;
	w[k + 1] = 1 - w[k];
	return at;
}

struct solved {
	float p[3][FIELD], w[3][FIELD], k[3][FIELD], gain[FIELD];
	unsigned char status[FIELD];
};

static void solve(struct solved *n, const struct scene *s)
{
	if (s->refraction.data || s->refraction.steps)
		refraction_batch(&s->refraction, FIELD, n->p[0], n->p[1], n->p[2], n->w[0], n->w[1], n->w[2], n->k[0], n->k[1], n->k[2], 0, n->status);
	else
		lightpath_batch(FIELD, n->p[0], n->p[1], n->p[2], n->w[0], n->w[1], n->w[2], n->k[0], n->k[1], n->k[2], n->status, &s->cornea, SCENE_PATH_STEPS);
	lightpath_gain_batch(FIELD, n->p[0], n->p[1], n->p[2], n->w[0], n->w[1], n->w[2], n->k[0], n->k[1], n->k[2], n->gain, &s->cornea);
}

static void angle_make(float field[CHANNELS][FIELD], const struct scene *s, double angle, double z, double most)
{
	struct solved *n = mem_array(1, sizeof *n);
	const float w[3] = { (float)sin(angle), 0, (float)-cos(angle) };
	for (int i = 0; i < FIELD; i++) {
		double r = most * (i / ROW) / (RINGS - 1), turn = 2 * M_PI * (i % ROW % TURNS) / TURNS;
		n->p[0][i] = (float)(r * cos(turn));
		n->p[1][i] = (float)(r * sin(turn));
		n->p[2][i] = (float)z;
		for (int c = 0; c < 3; c++)
			n->w[c][i] = w[c];
	}
	solve(n, s);
	for (int i = 0; i < FIELD; i++) {
		bool none = n->status[i] == LIGHTPATH_NONE, lit = n->status[i] == LIGHTPATH_OK || n->status[i] == LIGHTPATH_BEYOND_RIM;
		double d[3];
		for (int c = 0; c < 3; c++)
			d[c] = none ? w[c] : n->k[c][i] - n->p[c][i];
		field[AT_X][i] = n->p[0][i] + (float)d[0];
		field[AT_Y][i] = n->p[1][i] + (float)d[1];
		vec_unit(d, d);
		for (int c = 0; c < 3; c++)
			field[DIR_X + c][i] = (float)d[c];
		float gain = lit && n->gain[i] > 0 && n->gain[i] < 1e6f ? n->gain[i] : 0;
		field[POWER][i] = gain / fmaxf((float)-d[2], 0.05f);
	}
	free(n);
}

/* Places the points of a square grid among rings and turns. Outside the limbus there is no iris: those points only bound the
 * cells of others, and are placed at its edge. */
static void nodes_place(struct paths_place *to, int side, double from, double step, double most, int rings)
{
	for (int i = 0; i < side * side; i++) {
		double x = i % side * step - from, y = i / side * step - from, turn = atan2(y, x) / (2 * M_PI) * TURNS;
		double ring = fmin(hypot(x, y) / most, 1) * (rings - 1);
		turn += turn < 0 ? TURNS : 0;
		int first = cubic_of(to[i].ring, (float)ring, rings), column = (int)turn % TURNS;
		cubic(to[i].turn, (float)(turn - floor(turn)));
		to[i].first = first * ROW + (column + TURNS - 1) % TURNS;
	}
}

/* The field on the iris plane, between the two planes, for flat light; finer rings by cubic interpolation. */
static void plain_make(struct scene_paths *p, int angle, float q)
{
	const float(*near)[FIELD] = (const float(*)[FIELD])p->field[0][angle], (*far)[FIELD] = (const float(*)[FIELD])p->field[1][angle];
	float plane[PLAIN_CHANNELS][FIELD];
	for (int i = 0; i < FIELD; i++) {
		float power = near[POWER][i] + q * (far[POWER][i] - near[POWER][i]), z = near[DIR_Z][i] + q * (far[DIR_Z][i] - near[DIR_Z][i]);
		plane[PLAIN_FALL][i] = z < 0 ? -z * power : 0;
		plane[PLAIN_X][i] = near[AT_X][i] + q * (far[AT_X][i] - near[AT_X][i]);
		plane[PLAIN_Y][i] = near[AT_Y][i] + q * (far[AT_Y][i] - near[AT_Y][i]);
	}
	for (int ring = 0; ring < PLAIN_RINGS; ring++) {
		float w[4];
		int first = cubic_of(w, (float)ring / PLAIN_FINER, RINGS) * ROW;
		for (int c = 0; c < PLAIN_CHANNELS; c++)
			for (int i = 0; i < ROW; i++) {
				const float *a = plane[c] + first + i;
				p->plain[angle][c][ring * ROW + i] = w[0] * a[0] + w[1] * a[ROW] + w[2] * a[2 * ROW] + w[3] * a[3 * ROW];
			}
	}
}

struct scene_paths *scene_paths_make(const struct scene *s)
{
	if (s->conf.shading != SCENE_TEXELS || s->conf.path != SCENE_PATH_GRID)
		return 0;
	struct scene_paths *p = mem_array(1, sizeof *p);
	double z[2];
	scene_planes(z, s);
	p->most = 1.04 * s->limbus[0];
	nodes_place(p->coarse, SCENE_COARSE, s->extent, 2 * s->extent / (SCENE_COARSE - 1), p->most, RINGS);
	nodes_place(p->flat, SCENE_FLAT, s->extent * (1 - 1.0 / SCENE_FLAT), 2 * s->extent / SCENE_FLAT, p->most, PLAIN_RINGS);
#pragma omp parallel for schedule(dynamic)
	for (int i = 0; i < 2 * ANGLES; i++)
		angle_make(p->field[i % 2][i / 2], s, acos(-lowest) * (i / 2) / (ANGLES - 1), z[i % 2], p->most);
#pragma omp parallel for schedule(static)
	for (int i = 0; i < ANGLES; i++)
		plain_make(p, i, (float)((s->eye.iris_depth - z[0]) / (z[1] - z[0])));
	return p;
}

/* Sums over the lights of a beam at the nodes, as struct plane_sum (beam.c). */
struct sum {
	float power[FIELD], dir[3][FIELD], down[3][FIELD], rho[FIELD];
};

SIMD_CLONES static void field_at(float *restrict out, const float *restrict field, const struct paths_light *light)
{
	for (int ring = 0; ring < RINGS; ring++)
		scene_paths_row(out + ring * ROW, ROW, field + ring * ROW, CHANNELS * FIELD, light);
}

SIMD_CLONES static void light_add(struct sum *sum, const float (*restrict f)[FIELD], float cosine, float sine, float share, const double limbus[2])
{
	float per_x = (float)(1 / limbus[0]), per_y = (float)(1 / limbus[1]);
	SIMD_LOOP
	for (int i = 0; i < FIELD; i++) {
		float dx = cosine * f[DIR_X][i] - sine * f[DIR_Y][i], dy = sine * f[DIR_X][i] + cosine * f[DIR_Y][i], dz = f[DIR_Z][i];
		float x = per_x * (cosine * f[AT_X][i] - sine * f[AT_Y][i]), y = per_y * (sine * f[AT_X][i] + cosine * f[AT_Y][i]);
		float power = share * ((f[POWER][i] > 0 ? f[POWER][i] : 0) + 1e-9f);  // where none comes, a direction still
		sum->power[i] += power;
		sum->dir[0][i] += power * dx;
		sum->dir[1][i] += power * dy;
		sum->dir[2][i] += power * dz;
		sum->rho[i] += power * sqrtf(x * x + y * y);
		power *= -dz;
		sum->down[0][i] += power * dx;
		sum->down[1][i] += power * dy;
		sum->down[2][i] += power * dz;
	}
}

SIMD_CLONES static void ways_put(float (*restrict way)[SCENE_WAY], const struct sum *restrict sum)
{
	for (int i = 0; i < FIELD; i++) {
		scene_beam_direction(way[i], sum->power[i], (float[3]){ sum->dir[0][i], sum->dir[1][i], sum->dir[2][i] },
		                     (float[3]){ sum->down[0][i], sum->down[1][i], sum->down[2][i] });
		way[i][3] = sum->power[i];
		way[i][4] = 1 / sum->power[i] * sum->rho[i];
		way[i][6] = way[i][7] = 0;
	}
}

SIMD_CLONES static void table_put(float (*restrict way)[SCENE_WAY], const float (*restrict polar)[SCENE_WAY], const struct scene_paths *p)
{
	for (int i = 0; i < SCENE_COARSE * SCENE_COARSE; i++) {
		const float *w = p->coarse[i].ring, *t = p->coarse[i].turn;
		const float(*restrict from)[SCENE_WAY] = polar + p->coarse[i].first;
		float sum[SCENE_WAY] = { 0 };
		for (int k = 0; k < 4; k++)
			for (int c = 0; c < SCENE_WAY; c++)
				sum[c] += w[k] * (t[0] * from[k * ROW][c] + t[1] * from[k * ROW + 1][c] + t[2] * from[k * ROW + 2][c] + t[3] * from[k * ROW + 3][c]);
		memcpy(way[i], sum, sizeof sum);
	}
}

struct paths_light scene_paths_light(const float d[3])
{
	struct paths_light light;
	float flat = hypotf(d[0], d[1]);
	light.cosine = flat > 0 ? d[0] / flat : 1;
	light.sine = flat > 0 ? d[1] / flat : 0;
	light.angle = cubic_of(light.in_angle, (float)(atan2(flat, -d[2]) / acos(-lowest) * (ANGLES - 1)), ANGLES);
	float back = -atan2f(light.sine, light.cosine) * (float)(TURNS / (2 * M_PI)), whole = floorf(back);
	cubic(light.in_turn, back - whole);
	light.turn = ((int)whole - 1 + 2 * TURNS) % TURNS;
	return light;
}

void scene_paths_beam(float way[][SCENE_WAY], const struct scene *s, int plane, const struct beam_lights *in)
{
	const struct scene_paths *p = s->paths;
	struct {
		struct sum sum;
		float field[CHANNELS][FIELD], polar[FIELD][SCENE_WAY];
	} *work = mem_array(1, sizeof *work);
	work->sum = (struct sum){ 0 };
	for (int l = 0; l < in->n; l++) {
		struct paths_light light = scene_paths_light(in->dir[l]);
		for (int c = 0; c < CHANNELS; c++)
			field_at(work->field[c], p->field[plane][light.angle][c], &light);
		light_add(&work->sum, (const float(*)[FIELD])work->field, light.cosine, light.sine, in->share[l], s->limbus);
	}
	ways_put(work->polar, &work->sum);
	table_put(way, (const float(*)[SCENE_WAY])work->polar, p);
	free(work);
}
