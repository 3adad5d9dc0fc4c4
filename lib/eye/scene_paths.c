/* Fields of a light's ways on two planes of the iris, by the light's angle from the axis: at rings of turns about it, the light
 * standing at azimuth 0. A light between two angles and turned to any azimuth is their cubic (Catmull and Rom's); all nodes of
 * the field share its weights. */
#include "eye/scene_paths.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "math/vec.h"

#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC optimize("no-tree-pre", "fp-contract=fast")  // see scene_meet.c, simd.h
#endif

/* Unit direction from the point to where the light comes in, irradiance of a plane that faces it, and the place on the cornea. */
enum { DIR_X, DIR_Y, DIR_Z, POWER, AT_X, AT_Y, CHANNELS };
enum { ANGLES = 64, RINGS = 24, TURNS = 64, WRAP = 4, ROW = TURNS + WRAP, FIELD = RINGS * ROW };
static const double lowest = 0.16;  // z of the last angle's light: see scene_lights_turn

struct scene_paths {
	double most;                                 // radius of the last ring, mm
	float field[2][ANGLES][CHANNELS][FIELD];     // a row is a ring, and its first turns once more
	float at[SCENE_COARSE * SCENE_COARSE][8];        // weights of four rings and four turns for a coarse node of a beam's table
	int first[SCENE_COARSE * SCENE_COARSE];          // ring and turn of the first of them
};

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

/* Where the coarse nodes of a beam's table lie among rings and turns. Outside the limbus there is no iris to light: those nodes only
 * bound the others' cells, and stand at its edge. */
static void nodes_place(struct scene_paths *p, const struct scene *s)
{
	double step = 2 * s->extent / (SCENE_COARSE - 1);
	for (int i = 0; i < SCENE_COARSE * SCENE_COARSE; i++) {
		double x = i % SCENE_COARSE * step - s->extent, y = i / SCENE_COARSE * step - s->extent, turn = atan2(y, x) / (2 * M_PI) * TURNS;
		double ring = fmin(hypot(x, y) / p->most, 1) * (RINGS - 1);
		turn += turn < 0 ? TURNS : 0;
		int first = cubic_of(p->at[i], (float)ring, RINGS), column = (int)turn % TURNS;
		cubic(p->at[i] + 4, (float)(turn - floor(turn)));
		p->first[i] = first * ROW + (column + TURNS - 1) % TURNS;
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
	nodes_place(p, s);
#pragma omp parallel for schedule(dynamic)
	for (int i = 0; i < 2 * ANGLES; i++)
		angle_make(p->field[i % 2][i / 2], s, acos(-lowest) * (i / 2) / (ANGLES - 1), z[i % 2], p->most);
	return p;
}

/* What the lights of a beam bring to the nodes: power, that times direction, times direction and how far it goes down, and times
 * the place on the cornea. */
struct sum {
	float power[FIELD], dir[3][FIELD], down[3][FIELD], rho[FIELD];
};

/* A light's field: four angles and, of each ring, four turns. */
SIMD_CLONES static void field_at(float *restrict out, const float *restrict a, const float *restrict b, const float *restrict c, const float *restrict d,
                                 const float in_angle[4], const float in_turn[4], int turn)
{
	for (int ring = 0; ring < RINGS; ring++) {
		float row[2 * ROW];
		long at = (long)ring * ROW;
		SIMD_LOOP
		for (int i = 0; i < TURNS; i++)
			row[i] = row[i + TURNS] = in_angle[0] * a[at + i] + in_angle[1] * b[at + i] + in_angle[2] * c[at + i] + in_angle[3] * d[at + i];
		memcpy(row + 2 * TURNS, row, (2 * ROW - 2 * TURNS) * sizeof *row);
		const float *restrict from = row + turn;
		SIMD_LOOP
		for (int i = 0; i < ROW; i++)
			out[at + i] = in_turn[0] * from[i] + in_turn[1] * from[i + 1] + in_turn[2] * from[i + 2] + in_turn[3] * from[i + 3];
	}
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
		const float *w = p->at[i];
		const float(*restrict from)[SCENE_WAY] = polar + p->first[i];
		float sum[SCENE_WAY] = { 0 };
		for (int k = 0; k < 4; k++)
			for (int c = 0; c < SCENE_WAY; c++)
				sum[c] += w[k] * (w[4] * from[k * ROW][c] + w[5] * from[k * ROW + 1][c] + w[6] * from[k * ROW + 2][c] + w[7] * from[k * ROW + 3][c]);
		memcpy(way[i], sum, sizeof sum);
	}
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
		const float *d = in->dir[l];
		float flat = hypotf(d[0], d[1]), in_angle[4], in_turn[4], cosine = flat > 0 ? d[0] / flat : 1, sine = flat > 0 ? d[1] / flat : 0;
		int k = cubic_of(in_angle, (float)(atan2(flat, -d[2]) / acos(-lowest) * (ANGLES - 1)), ANGLES);
		float back = -atan2f(sine, cosine) * (float)(TURNS / (2 * M_PI)), whole = floorf(back);
		cubic(in_turn, back - whole);
		for (int c = 0; c < CHANNELS; c++)
			field_at(work->field[c], p->field[plane][k][c], p->field[plane][k + 1][c], p->field[plane][k + 2][c], p->field[plane][k + 3][c], in_angle, in_turn,
			         ((int)whole - 1 + 2 * TURNS) % TURNS);
		light_add(&work->sum, (const float(*)[FIELD])work->field, cosine, sine, in->share[l], s->limbus);
	}
	ways_put(work->polar, &work->sum);
	table_put(way, (const float(*)[SCENE_WAY])work->polar, p);
	free(work);
}
