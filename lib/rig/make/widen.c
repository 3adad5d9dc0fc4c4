/* A sheet of faces that poses narrow: what each lacks of its least breadth, and the move that gives it, are found in turn (the local and the global step of Bouaziz et al., Projective
 * Dynamics, 2014). */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "rig/make/unfold_impl.h"

enum { ROUNDS = 10, STEPS = 60 };                  // of both in turn; of conjugate gradients
static const double smooth = 0.01, small = 0.001;  // what a change of the move from place to place weighs, and the move itself, 1/mm^2

/* Room, [n]; mass: the area about a vertex, mm^2; weight: [n_leaves] of a move's change over a face: of what is smooth, and of the poses that narrow it. */
struct room {
	double *mass, *weight, (*force)[2], (*way)[2], (*product)[2];
};

/* How a face's picture in a pose follows from that at rest: a stretched rotation and a stretched mirror image, by where they take the first unit vector. */
struct stretch {
	double turn[2], mirror[2];
};

static struct stretch stretch_of(const struct sheet *s, const struct sheet_pose *p, const struct leaf *l)
{
	double J[2][2] = { { 0 } };
	for (int k = 0; k < 3; k++)
		for (int c = 0; c < 2; c++) {
			const double at = p->at[l->v[k]][c] + p->closed * (s->move[l->v[k]][c] - s->added[l->v[k]][c]);
			J[c][0] += at * l->slope[k][0];
			J[c][1] += at * l->slope[k][1];
		}
	return (struct stretch){ { 0.5 * (J[0][0] + J[1][1]), 0.5 * (J[1][0] - J[0][1]) }, { 0.5 * (J[0][0] - J[1][1]), 0.5 * (J[1][0] + J[0][1]) } };
}

/* The lesser singular value. */
static double breadth_of(const struct stretch *t)
{
	return hypot(t->turn[0], t->turn[1]) - hypot(t->mirror[0], t->mirror[1]);
}

double sheet_breadth(const struct sheet *s, const struct sheet_pose *p, const struct leaf *l)
{
	const struct stretch t = stretch_of(s, p, l);
	return breadth_of(&t);
}

/* Adds to the forces on a face's corners what the nearest picture of that breadth differs by. False: it is as broad. */
static bool push(double (*force)[2], const struct sheet *s, const struct sheet_pose *p, const struct leaf *l, double least)
{
	const struct stretch t = stretch_of(s, p, l);
	const double lack = least - breadth_of(&t);
	if (!(lack > 0))
		return false;
	const double a = 0.5 * lack / fmax(hypot(t.turn[0], t.turn[1]), 1e-9), b = -0.5 * lack / fmax(hypot(t.mirror[0], t.mirror[1]), 1e-9);
	const double more[2][2] = { { a * t.turn[0] + b * t.mirror[0], -a * t.turn[1] + b * t.mirror[1] }, { a * t.turn[1] + b * t.mirror[1], a * t.turn[0] - b * t.mirror[0] } };
	for (int k = 0; k < 3; k++)
		for (int c = 0; c < 2; c++)
			force[l->v[k]][c] += p->closed * l->area * (more[c][0] * l->slope[k][0] + more[c][1] * l->slope[k][1]);
	return true;
}

/* What may not move is pushed by nothing. */
static void hold(double (*x)[2], const struct sheet *s)
{
	for (int i = 0; i < s->n; i++)
		if (!(s->may[i] > 0))
			x[i][0] = x[i][1] = 0;
}

/* out = A x: half the slope of the square form of moves. weight: null: as of what is smooth alone. */
static void apply(double (*out)[2], const struct sheet *s, const double *mass, double (*x)[2], const double *weight)
{
	for (int i = 0; i < 2 * s->n; i++)
		out[i / 2][i % 2] = s->may[i / 2] > 0 ? small * mass[i / 2] / (s->may[i / 2] * s->may[i / 2]) * x[i / 2][i % 2] : 0;
	for (int f = 0; f < s->n_leaves; f++) {
		const struct leaf *l = &s->leaf[f];
		for (int c = 0; c < 2; c++) {
			double g[2] = { 0 };
			for (int k = 0; k < 6; k++)
				g[k % 2] += x[l->v[k / 2]][c] * l->slope[k / 2][k % 2];
			for (int k = 0; k < 3; k++)
				out[l->v[k]][c] += (weight ? weight[f] : smooth) * l->area * (g[0] * l->slope[k][0] + g[1] * l->slope[k][1]);
		}
	}
	hold(out, s);
}

static double dot(int n, double (*a)[2], double (*b)[2])
{
	double sum = 0;
	for (int i = 0; i < 2 * n; i++)
		sum += a[i / 2][i % 2] * b[i / 2][i % 2];
	return sum;
}

/* Adds to the move A^-1 force, by conjugate gradients. */
static void give_way(struct sheet *s, struct room *r)
{
	double now = dot(s->n, r->force, r->force);
	const double enough = 1e-6 * now;
	memcpy(r->way, r->force, (size_t)s->n * sizeof *r->way);
	for (int k = 0; k < STEPS && now > enough; k++) {
		apply(r->product, s, r->mass, r->way, r->weight);
		const double by = now / dot(s->n, r->way, r->product), was = now;
		for (int i = 0; i < 2 * s->n; i++) {
			s->move[i / 2][i % 2] += by * r->way[i / 2][i % 2];
			r->force[i / 2][i % 2] -= by * r->product[i / 2][i % 2];
		}
		now = dot(s->n, r->force, r->force);
		for (int i = 0; i < 2 * s->n; i++)
			r->way[i / 2][i % 2] = r->force[i / 2][i % 2] + now / was * r->way[i / 2][i % 2];
	}
}

void sheet_widen(struct sheet *s)
{
	const size_t n = (size_t)s->n + 1;
	struct room r = { mem_new(n, sizeof *r.mass), mem_new((size_t)s->n_leaves + 1, sizeof *r.weight), mem_new(n, sizeof *r.force), mem_new(n, sizeof *r.way), mem_new(n, sizeof *r.product) };
	for (int k = 0; k < 3 * s->n_leaves; k++)
		r.mass[s->leaf[k / 3].v[k % 3]] += s->leaf[k / 3].area / 3;
	for (int k = 0; k < ROUNDS; k++) {
		apply(r.product, s, r.mass, s->move, 0);
		for (int i = 0; i < 2 * s->n; i++)
			r.force[i / 2][i % 2] = -r.product[i / 2][i % 2];
		for (int f = 0; f < s->n_leaves; f++) {
			r.weight[f] = smooth;
			for (int p = 0; p < s->n_poses; p++)
				if (push(r.force, s, &s->pose[p], &s->leaf[f], s->pose[p].least[f]))
					r.weight[f] += s->pose[p].closed * s->pose[p].closed;
		}
		hold(r.force, s);
		give_way(s, &r);
	}
	free(r.mass);
	free(r.weight);
	free(r.force);
	free(r.way);
	free(r.product);
}

void sheet_free(struct sheet *s)
{
	for (int p = 0; p < s->n_poses; p++) {
		free(s->pose[p].at);
		free(s->pose[p].least);
	}
	free(s->pose);
	free(s->leaf);
	free(s->may);
	free(s->move);
	free(s->added);
	*s = (struct sheet){ 0 };
}
