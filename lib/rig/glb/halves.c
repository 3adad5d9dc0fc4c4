#include "rig/glb/halves.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "math/vec.h"
#include "rig/drive.h"

enum { STEPS = 8, NEAR_END = 2, ROUNDS = 2 };  // nearer than that to an end, faces would need much of a target that hardly moves there
static const double lining_mm = 0.3;    // of an eyeball of 12 mm: lids are five times as thick, and two targets add up
static const double outside_mm = 0.2;   // what lies deeper at an end lines the lid: it may go deeper on the way, too

/* Skin, its normals and hairs, one behind the other: displacements from rest. */
struct stack {
	size_t skin, all;   // numbers of the first two each; of all three
	float *still, *shut, *now;
};

static void take(float *to, const struct poser *p, const struct glb_bake *b, const struct stack *s)
{
	poser_skin(to, to + s->skin, p, b->n, b->vertex);
	poser_hair(to + 2 * s->skin, p);
}

/* What the way lacks on average, weighted as the target will be: out[s->all]. */
static void fit(float *out, struct poser *p, const struct glb_bake *b, struct stack *s)
{
	double square = 0, *controls = mem_new((size_t)p->rig->n_inputs + 1, sizeof *controls);
	drive_look(controls, p->rig, 0, 0, 0);
	poser_still(p);
	take(s->still, p, b, s);
	poser_from_still(p, controls, 1);
	take(s->shut, p, b, s);
	for (int step = 1; step < STEPS; step++) {
		const double w = (double)step / STEPS, weight = glb_half_weight(w);
		poser_from_still(p, controls, w);
		take(s->now, p, b, s);
		for (size_t i = 0; i < s->all; i++)
			out[i] += (float)(weight * ((double)s->now[i] - s->still[i] - w * ((double)s->shut[i] - s->still[i])));
		square += weight * weight;
	}
	for (size_t i = 0; i < s->all; i++)
		out[i] /= (float)square;
	free(controls);
}

/* A moving vertex i at the blink's weight w: from + w blink + 4 w (1 - w) half. from: null: rest. */
static void on_the_way(float x[3], const struct rig *rig, const struct glb_bake *b, int i, const float *from, const float *blink, const float *half, double w)
{
	for (int c = 0; c < 3; c++)
		x[c] = (float)(rig->rest[b->vertex[i]][c] + (from ? from[3 * i + c] : 0) + w * blink[3 * i + c] + glb_half_weight(w) * half[3 * i + c]);
}

static double distance(const struct poser *p, int vertex, const float x[3])
{
	const int side = p->rig->side[vertex];
	return rig_globe_distance(p->rig, side, (const double(*)[3])p->turn[side], x);
}

/* Least distance of each vertex from the eye at both ends; -INFINITY on the other eye's side, and of what is not outside it. */
static void find_ends(double *ends, const struct poser *p, const struct glb_bake *b, const float *from, const float *blink, int eye)
{
	for (int i = 0; i < b->n; i++) {
		float x[2][3];
		for (int end = 0; end < 2; end++)
			on_the_way(x[end], p->rig, b, i, from, blink, blink, end);
		ends[i] = fmin(distance(p, b->vertex[i], x[0]), distance(p, b->vertex[i], x[1]));
		if (p->rig->side[b->vertex[i]] != eye || ends[i] < -outside_mm)
			ends[i] = -INFINITY;
	}
}

/* How much further off the eye than in its pose x a vertex has to be: as far as at its ends. */
static double lack_of(const struct poser *p, int vertex, const float x[3], double ends)
{
	return fmin(ends, DEFORM_CLEAR_MM) - distance(p, vertex, x);
}

/* A vertex in its pose x, away from the eye's centre until it is as far off as it has to be. */
static void lift(float x[3], const struct poser *p, int vertex, double ends)
{
	const double lack = lack_of(p, vertex, x, ends);
	double d[3];
	for (int c = 0; c < 3; c++)
		d[c] = x[c] - p->rig->globe[p->rig->side[vertex]].center[c];
	const double far = vec_norm(d);
	for (int c = 0; c < 3 && lack > 0; c++)
		x[c] += (float)(lack * d[c] / far);
}

/* What lines a lid, and looks at the eyeball, may give way to it by no more than a lid is thick, over all of the way. x: in, out; was: before; given: so far. */
static void hold(float x[3], double *given, const struct poser *p, int vertex, const float was[3], double weight)
{
	const struct rig_globe *globe = &p->rig->globe[p->rig->side[vertex]];
	double d[3];
	for (int c = 0; c < 3; c++)
		d[c] = (double)x[c] - (double)was[c];
	const double by = vec_norm(d) / weight;
	if (!(by > 0) || !deform_lines(p->rig, vertex))
		return;
	const double may = fmin(by, fmax(lining_mm * globe->radius / 12 - *given, 0));
	*given += may;
	for (int c = 0; c < 3; c++)
		x[c] = was[c] + (float)(d[c] * may / by);
}

/* Moves skin, between the ends, out of the eye, and with it edges and faces, as in poses. given: by vertex, what it has moved so by clearing edges and faces. */
static void clear(float *half, double *given, struct poser *p, const struct glb_bake *b, const float *from, const float *blink, const double *ends)
{
	for (int step = 1; step < STEPS; step++) {
		const double w = (double)step / STEPS;
		float x[3];
		for (int i = 0; i < b->n; i++)
			on_the_way(p->x[b->vertex[i]], p->rig, b, i, from, blink, half, w);
		if (step >= NEAR_END && step <= STEPS - NEAR_END)
			deform_clear(p->x, p->rig, &p->near, (const double(*)[3][3])p->turn);
		for (int i = 0; i < b->n; i++) {
			if (!isfinite(ends[i]))
				continue;
			on_the_way(x, p->rig, b, i, from, blink, half, w);
			hold(p->x[b->vertex[i]], &given[i], p, b->vertex[i], x, glb_half_weight(w));
			lift(p->x[b->vertex[i]], p, b->vertex[i], ends[i]);
			for (int c = 0; c < 3; c++)
				half[3 * i + c] += (float)((double)(p->x[b->vertex[i]][c] - x[c]) / glb_half_weight(w));
		}
	}
}

/* Moves skin, by a target half of that weight, out of the eye on the way of another one, blink, from a pose `from` (null: from rest). */
static void clear_way(float *half, struct poser *p, const struct glb_bake *b, const float *from, const float *blink, int eye)
{
	double *ends = mem_new((size_t)b->n + 1, sizeof *ends), *given = mem_new((size_t)b->n + 1, sizeof *given);
	find_ends(ends, p, b, from, blink, eye);
	for (int round = 0; round < ROUNDS; round++)
		clear(half, given, p, b, from, blink, ends);
	free(ends);
	free(given);
}

void glb_lead_round(float *out, const float *half, struct poser *p, const struct glb_bake *b, const float *from, const float *blink, int eye)
{
	const size_t row = 3 * (size_t)b->n;
	memcpy(out, half, row * sizeof *out);
	clear_way(out, p, b, from, blink, eye);
	for (size_t i = 0; i < row; i++)
		out[i] -= half[i];
}

double glb_way_lacks(const float *half, const struct poser *p, const struct glb_bake *b, const float *from, const float *blink, int eye)
{
	double *ends = mem_new((size_t)b->n + 1, sizeof *ends), most = 0;
	find_ends(ends, p, b, from, blink, eye);
	for (int step = 1; step < STEPS; step++)
		for (int i = 0; i < b->n; i++) {
			float x[3];
			on_the_way(x, p->rig, b, i, from, blink, half, (double)step / STEPS);
			most = isfinite(ends[i]) ? fmax(most, lack_of(p, b->vertex[i], x, ends[i])) : most;
		}
	free(ends);
	return most;
}

void glb_take_halves(struct glb_bake *b, struct poser *p)
{
	const size_t row = 3 * (size_t)b->n, hair = 3 * (size_t)b->n_hair;
	struct stack s = { .skin = row, .all = 2 * row + hair };
	s.still = mem_array(s.all + 1, sizeof *s.still);
	s.shut = mem_array(s.all + 1, sizeof *s.shut);
	s.now = mem_array(s.all + 1, sizeof *s.now);
	for (int eye = 0; eye < GLB_HALVES; eye++) {
		const size_t at = (size_t)(b->n_poses - GLB_HALVES + eye);
		const float *blink = b->pose + (size_t)eye * row;
		float *half = mem_new(s.all + 1, sizeof *half), *skin = b->pose + at * row, *lean = b->pose_lean + at * row, *hairs = b->hair_pose + at * hair;
		fit(half, p, b, &s);
		b->pose_name[at] = mem_str(glb_half_names[eye]);
		b->driven[at] = (struct glb_driven){ eye, -1, true };
		for (size_t i = 0; i < row; i++) {
			const float share = poser_own_side(p, eye, p->rig->rest[b->vertex[i / 3]]);
			skin[i] = share * half[i];
			lean[i] = share * half[row + i];
		}
		for (size_t i = 0; i < hair; i++)
			hairs[i] = poser_own_side(p, eye, p->hair_rest[i / 3]) * half[2 * row + i];
		clear_way(skin, p, b, 0, blink, eye);
		free(half);
	}
	free(s.still);
	free(s.shut);
	free(s.now);
}
