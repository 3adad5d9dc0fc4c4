#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "math/vec.h"
#include "register/nricp/align_impl.h"

enum { CUBE = 24, STEP = 4, KEEP = 6 };

void align_cube(double out[24][3][3])
{
	int n = 0;
	memset(out, 0, CUBE * sizeof *out);
	for (int code = 0; code < 48; code++) {
		int axis[3] = { code / 16, 0, 0 }, odd = code / 8 & 1;
		axis[1] = (axis[0] + 1 + odd) % 3;
		axis[2] = 3 - axis[0] - axis[1];
		int sign[3] = { code & 1 ? -1 : 1, code & 2 ? -1 : 1, code & 4 ? -1 : 1 };
		if (sign[0] * sign[1] * sign[2] * (odd ? -1 : 1) < 0)
			continue;
		for (int k = 0; k < 3; k++)
			out[n][k][axis[k]] = sign[k];
		n++;
	}
}

/* Whether two poses are the same but for what the refinement leaves. */
static bool alike(const struct pose *a, const struct pose *b)
{
	static const double turn = 0.35, shift = 0.25, growth = 0.2;  // radians; sizes of the fixed mesh; of the scale's logarithm
	double trace = 0, d[3];
	for (int k = 0; k < 9; k++)
		trace += (&a->rotation[0][0])[k] * (&b->rotation[0][0])[k];
	vec_add(d, a->shift, -1, b->shift);
	return acos(fmin(fmax((trace - 1) / 2, -1), 1)) < turn && vec_norm(d) < shift * fmin(a->scale, b->scale)
	       && fabs(log(a->scale / b->scale)) < growth;
}

/* The best starts after a few rounds with few samples, best first. */
struct shortlist {
	int n;
	struct {
		struct pose pose;
		double matched;
	} at[KEEP];
};

static void consider(struct shortlist *l, struct search *s, struct pose pose, int rounds, int step)
{
	static const double coarse[2] = { 0.5, 0.2 };
	double rms, matched = align_refine(&pose, &rms, s, rounds, coarse, step);
	int at = l->n;
	for (int i = 0; i < l->n; i++)
		if (alike(&l->at[i].pose, &pose)) {
			if (l->at[i].matched < matched) {
				l->at[i].pose = pose;
				l->at[i].matched = matched;
			}
			return;
		}
	while (at > 0 && l->at[at - 1].matched < matched) {
		if (at < KEEP)
			l->at[at] = l->at[at - 1];
		at--;
	}
	if (at < KEEP) {
		l->at[at].pose = pose;
		l->at[at].matched = matched;
		l->n += l->n < KEEP;
	}
}

/* A fine share, less where the scale is far from 1: heads in mm are of one size, within a factor of two or so, and wrong poses shrink
 * the fixed mesh until it fits anything. */
static double worth(double fine, const struct pose *pose)
{
	static const double sigma = 0.6;  // of the logarithm of the scale; an assumption
	double off = log(pose->scale) / sigma;
	return fine * exp(-0.5 * off * off);
}

/* Poses that were refined, and what they are worth by the fine scale. */
struct tried {
	int n;
	struct pose pose[2 * KEEP + 1];
	double fine[2 * KEEP + 1];
};

static void refine_all(struct tried *t, struct search *s, const struct shortlist *l)
{
	enum { ROUNDS = 6 };
	const double narrower[2] = { 0.5 * (s->conf->welsch[0] + s->conf->welsch[1]), s->conf->welsch[1] };
	for (int i = 0; i < l->n; i++) {
		struct pose pose = l->at[i].pose;
		double rms;
		align_refine(&pose, &rms, s, ROUNDS, narrower, STEP / 2);
		t->fine[t->n] = worth(align_narrow(&pose, s, STEP / 2), &pose);
		t->pose[t->n++] = pose;
	}
}

/* The best fine share of those that differ from the pose. One that seems near to it may not have arrived yet: it is refined further. */
static double rival_of(struct tried *t, struct search *s, const struct pose *pose, double fine)
{
	double rival = 0;
	for (int i = 0; i < t->n; i++) {
		if (alike(&t->pose[i], pose))
			continue;
		if (!nricp_stands_out(fine, t->fine[i], s->conf->margin)) {
			double rms;
			align_refine(&t->pose[i], &rms, s, 2 * s->conf->rounds, s->conf->welsch, 1);
			t->fine[i] = worth(align_narrow(&t->pose[i], s, 1), &t->pose[i]);
		}
		if (!alike(&t->pose[i], pose))
			rival = fmax(rival, t->fine[i]);
	}
	return rival;
}

/* The best of all: as the meshes lie, unless one that was tried is better. */
static struct best choose(struct tried *t, struct search *s, const struct best *as_they_lie)
{
	struct best best = *as_they_lie;
	int top = -1;
	for (int i = 0; i < t->n; i++)
		if (t->fine[i] > fmax(1.02 * as_they_lie->fine, top < 0 ? 0 : t->fine[top]))
			top = i;
	if (top >= 0) {
		const double narrow[2] = { s->conf->welsch[1], s->conf->welsch[1] };
		struct best other = { .pose = t->pose[top] };
		align_finish(&other, s, narrow);
		other.fine = worth(other.fine, &other.pose);
		if (other.fine > best.fine)
			best = other;
	}
	best.rival = rival_of(t, s, &best.pose, best.fine);
	return best;
}

/* Starts with the centroids in one place, in all rotations. */
static void turned(struct shortlist *l, struct search *s, const double (*cube)[3][3], double about)
{
	double more[3][3] = { { cos(about), 0, sin(about) }, { 0, 1, 0 }, { -sin(about), 0, cos(about) } };
	for (int i = 0; i < CUBE; i++) {
		struct pose pose = pose_still;
		mat_mul(pose.rotation, cube[i], more);
		consider(l, s, pose, 5, STEP);
	}
}

/* Starts with the fixed mesh in all rotations at places all over the moving one, to find a face on a body. */
static void placed(struct shortlist *l, struct search *s, const double (*cube)[3][3])
{
	double *area = mesh_vertex_areas(&s->moving), sum = 0, passed = 0, out[3] = { 0 };
	int n = 0;
	for (int k = 0; k < s->n; k++)  // mean normal: the direction from the fixed mesh's centroid to its surface
		vec_add(out, out, 1.0 / s->n, s->samples[k].normal);
	for (int i = 0; i < s->moving.n_vertices; i++)
		sum += area[i];
	for (int i = 0; i < s->moving.n_vertices; i++) {
		passed += area[i];
		if (!(passed > sum * (n + 0.5) / s->conf->starts))
			continue;
		n++;
		for (int c = 0; c < CUBE; c++) {
			struct pose pose = pose_still;
			double way[3];
			memcpy(pose.rotation, cube[c], sizeof pose.rotation);
			mat_vec(way, pose.rotation, out);
			for (int k = 0; k < 3; k++)
				pose.shift[k] = (double)s->moving.vertices[i][k] - 0.5 * way[k];
			consider(l, s, pose, 3, 2 * STEP);
		}
	}
	free(area);
}

struct best align_find(struct search *s, const double offset[3])
{
	double cube[CUBE][3][3];
	struct best first = { .pose = pose_still }, best;
	struct shortlist near = { 0 }, far = { 0 };
	struct tried tried = { 0 };
	align_cube(cube);
	memcpy(first.pose.shift, offset, sizeof first.pose.shift);
	align_finish(&first, s, s->conf->welsch);
	first.fine = worth(first.fine, &first.pose);
	tried.pose[0] = first.pose;
	tried.fine[tried.n++] = first.fine;
	turned(&near, s, (const double(*)[3][3])cube, 0);
	refine_all(&tried, s, &near);
	best = choose(&tried, s, &first);
	if (best.fine < s->conf->good || !nricp_stands_out(best.fine, best.rival, s->conf->margin)) {
		turned(&far, s, (const double(*)[3][3])cube, M_PI / 4);
		if (s->conf->starts)
			placed(&far, s, (const double(*)[3][3])cube);
		refine_all(&tried, s, &far);
		best = choose(&tried, s, &first);
	}
	return best;
}
