/* Skin beside the corners of shut lids. Margins end at corners that hardly move; what lies a few millimetres above goes with the mean of the margin about it, an eyelid's height down. So it
 * comes down upon skin that stays, in expressions that lower brows or raise cheeks still further, and faces between them turn over. Here skin off the margins moves a little otherwise as eyes
 * close: by what leaves each face some of its breadth, as the front sees it, in those poses. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "math/rising.h"
#include "math/vec.h"
#include "rig/deform/deform.h"
#include "rig/drive.h"
#include "rig/make/make_impl.h"
#include "rig/make/unfold_impl.h"

enum { LOOKS = 5, CLOSINGS = 2 };            // times that poses are evaluated: what the sheet takes for straight goes round the eye
static const double closings[CLOSINGS] = { 1, 0.5 };
static const double least_share = 0.25;       // breadth of a face in a pose over that at rest, where it is narrowest
static const double front = 0.25;            // least cosine of a face at rest with the way to the front: others are folded, or line a lid
static const double held_mm[] = { 0.75, 2 };  // of an eyeball of 12 mm: skin as near to a margin stays where lids meet; from the second it is free
static const double far_mm[] = { 14, 20 };   // the same: from the first it is less so, from the second it is no lid

/* Share to which a vertex may move: none at the margins, nor far from them. */
static double may_move(const struct rig *rig, const struct rig_fissure *f, int i, double px_per_mm)
{
	const double unit = px_per_mm * rig->globe[rig->side[i]].radius / 12, x = rig->home[i][0] - f->x0, y = rig->home[i][1];
	double near = INFINITY;
	if (!(x > -far_mm[1] * unit) || !(x < f->width + far_mm[1] * unit))
		return 0;
	for (int k = 0; k < f->width; k++)
		if (f->bottom[k] > f->top[k])
			near = fmin(near, hypot(x - k, fmax(fmax(f->top[k] - y, y - f->bottom[k]), 0)));
	return rising(near / unit, held_mm[0], held_mm[1]) * (1 - rising(near / unit, far_mm[0], far_mm[1]));
}

/* A place as the front sees it. */
static void seen(double out[2], const struct rig *rig, const float x[3])
{
	for (int c = 0; c < 2; c++)
		out[c] = vec_dot(rig->head_from_target[c], (double[]){ x[0], x[1], x[2] });
}

/* False: the front sees it aslant at rest, or from behind. */
static bool leaf_of(struct leaf *l, const struct rig *rig, const int32_t v[3])
{
	double p[3][2], a[3], b[3], n[3];
	for (int c = 0; c < 3; c++) {
		a[c] = (double)rig->rest[v[1]][c] - (double)rig->rest[v[0]][c];
		b[c] = (double)rig->rest[v[2]][c] - (double)rig->rest[v[0]][c];
	}
	vec_cross(n, a, b);
	const double twice = vec_dot(n, rig->head_from_target[2]);
	for (int k = 0; k < 3; k++)
		seen(p[k], rig, rig->rest[v[k]]);
	l->area = 0.5 * twice;
	for (int k = 0; k < 3; k++) {
		const double *from = p[(k + 1) % 3], *to = p[(k + 2) % 3];
		l->slope[k][0] = (from[1] - to[1]) / twice;
		l->slope[k][1] = (to[0] - from[0]) / twice;
	}
	return twice > front * vec_norm(n);
}

/* Takes faces that may change. vertex: out, [sheet.n] of the rig; free(). */
static void find_leaves(struct sheet *s, int **vertex, const struct rig *rig, const struct rig_fissure *f, int side, double px_per_mm)
{
	int *number = mem_array((size_t)rig->n + 1, sizeof *number);
	double *may = mem_new((size_t)rig->n + 1, sizeof *may);
	*vertex = mem_array((size_t)rig->n + 1, sizeof **vertex);
	s->leaf = mem_array((size_t)rig->n_faces + 1, sizeof *s->leaf);
	for (int i = 0; i < rig->n; i++) {
		number[i] = -1;
		may[i] = rig->part[i] == RIG_SKIN && rig->side[i] == side ? may_move(rig, f, i, px_per_mm) : 0;
	}
	for (int k = 0; k < rig->n_faces; k++) {
		const int32_t *v = rig->faces[k];
		struct leaf l = { .held = !(may[v[0]] > 0 && may[v[1]] > 0 && may[v[2]] > 0) };
		if (!(may[v[0]] > 0 || may[v[1]] > 0 || may[v[2]] > 0) || !leaf_of(&l, rig, v))
			continue;
		for (int c = 0; c < 3; c++) {
			if (number[v[c]] < 0) {
				(*vertex)[s->n] = v[c];
				number[v[c]] = s->n++;
			}
			l.v[c] = number[v[c]];
		}
		s->leaf[s->n_leaves++] = l;
	}
	s->may = mem_new((size_t)s->n + 1, sizeof *s->may);
	s->move = mem_new((size_t)s->n + 1, sizeof *s->move);
	s->added = mem_new((size_t)s->n + 1, sizeof *s->added);
	for (int i = 0; i < s->n; i++)
		s->may[i] = may[(*vertex)[i]];
	free(number);
	free(may);
}

/* Both eyes shut, or half, straight ahead, without expression and with each in full. e: out, [sheet.n_poses] components; free(). */
static void find_poses(struct sheet *s, double (**e)[RIG_COMPONENTS], const struct rig *rig, const double closing[RIG_COMPONENTS])
{
	const int all = CLOSINGS * (rig->n_inputs - SKIN_EYE_INPUTS + 1);
	double *c = mem_new((size_t)rig->n_inputs + 1, sizeof *c);
	s->pose = mem_new((size_t)all, sizeof *s->pose);
	*e = mem_new((size_t)all, sizeof **e);
	for (int k = 0; k < all; k++) {
		const double open = 1 - closings[k % CLOSINGS];
		double closed = 0, *now = (*e)[s->n_poses];
		drive_look(c, rig, 0, 0, open);
		if (k >= CLOSINGS)
			drive_express(c, rig, k / CLOSINGS - 1, 1, open);
		rig_components(now, rig, c);
		for (int j = 0; j < RIG_COMPONENTS; j++)
			closed += (now[j] - rig->rest_e[j]) * closing[j];
		if (closed > 0.2)
			s->pose[s->n_poses++] = (struct sheet_pose){ closed, mem_new((size_t)s->n + 1, sizeof *s->pose->at), mem_new((size_t)s->n_leaves + 1, sizeof *s->pose->least) };
	}
	free(c);
}

/* Poses as they are. */
static void look(struct sheet *s, const struct rig *rig, const int *vertex, const double (*e)[RIG_COMPONENTS])
{
	struct deform *deform = deform_new(rig);
	float (*x)[3] = mem_new((size_t)rig->n + 1, sizeof *x);
	double turn[2][3][3];
	for (int eye = 0; eye < 2; eye++)
		rig_globe_rotation(turn[eye], rig, (double[]){ 0, 0, 0 });
	deform_rest(deform, x, 0);
	for (int k = 0; k < s->n_poses; k++) {
		deform_pose(deform, e[k], (const double(*)[3][3])turn, x, 0);
		for (int i = 0; i < s->n; i++)
			seen(s->pose[k].at[i], rig, x[vertex[i]]);
	}
	free(x);
	deform_free(deform);
}

/* Faces that end at a margin, which lids fold, are left no narrower than they were. */
static void find_least(struct sheet *s)
{
	for (int p = 0; p < s->n_poses; p++)
		for (int f = 0; f < s->n_leaves; f++)
			s->pose[p].least[f] = s->leaf[f].held ? fmin(sheet_breadth(s, &s->pose[p], &s->leaf[f]), least_share) : least_share;
}

/* Puts what moves are beyond what is in it already into the rig's motion. */
static void put(struct rig *rig, struct sheet *s, const int *vertex, const double closing[RIG_COMPONENTS], double px_per_mm)
{
	for (int i = 0; i < s->n; i++)
		for (int c = 0; c < 2; c++) {
			for (int k = 0; k < RIG_COMPONENTS; k++)
				rig->basis[vertex[i]][c * RIG_COMPONENTS + k] += (float)((s->move[i][c] - s->added[i][c]) * (c ? -1 : 1) * px_per_mm * closing[k]);
			s->added[i][c] = s->move[i][c];
		}
}

static void unfold(struct rig *rig, const struct rig_fissure *f, int side, const double closing[RIG_COMPONENTS], double px_per_mm)
{
	struct sheet s = { 0 };
	double (*e)[RIG_COMPONENTS];
	int *vertex;
	find_leaves(&s, &vertex, rig, f, side, px_per_mm);
	find_poses(&s, &e, rig, closing);
	for (int k = 0; k < LOOKS && s.n_poses; k++) {
		look(&s, rig, vertex, (const double(*)[RIG_COMPONENTS])e);
		if (!k)
			find_least(&s);
		sheet_widen(&s);
		put(rig, &s, vertex, closing, px_per_mm);
	}
	free(vertex);
	free(e);
	sheet_free(&s);
}

void rig_unfold_lids(struct rig *rig, const struct rig_motion *m, double px_per_mm)
{
	double shut[RIG_COMPONENTS], closing[RIG_COMPONENTS];
	const double still[RIG_COMPONENTS] = { 0 };
	rig_closed_pose(shut, rig);
	for (int side = 0; side < 2; side++) {
		struct rig_fissure f;
		if (!rig_fissure_new(&f, rig, m, side, (double[]){ 6 * px_per_mm, 3 * px_per_mm }))
			continue;
		rig_fissure_look(&f, rig, side, still);
		rig_closing_direction(closing, rig, side, shut);
		unfold(rig, &f, side, closing, px_per_mm);
		rig_fissure_free(&f);
	}
}
