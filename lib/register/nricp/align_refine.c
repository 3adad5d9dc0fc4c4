#include <math.h>
#include <string.h>

#include "math/chol.h"
#include "math/vec.h"
#include "register/nricp/align_impl.h"

/* Where the pose puts x. */
static void pose_place(double at[3], const struct pose *p, const double x[3])
{
	mat_vec(at, p->rotation, x);
	for (int k = 0; k < 3; k++)
		at[k] = p->scale * at[k] + p->shift[k];
}

static void add_row(struct sums *s, const double row[7], double residual, double weight)
{
	for (int i = 0; i < 7; i++) {
		for (int j = 0; j <= i; j++)
			s->a[i][j] += weight * row[i] * row[j];
		s->b[i] += weight * row[i] * residual;
	}
}

/* Adds one point at `about` from the pose's shift that should move by `off`: along m alone, or (null) in all directions. */
static void sums_add(struct sums *sums, const double about[3], const double off[3], const double m[3], double weight)
{
	static const double axes[3][3] = { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } };
	for (int k = 0; k < (m ? 1 : 3); k++) {
		const double *along = m ? m : axes[k];
		double row[7];
		vec_cross(row, about, along);
		memcpy(row + 3, along, 3 * sizeof *along);
		row[6] = vec_dot(about, along);
		add_row(sums, row, vec_dot(off, along), weight);
	}
}

/* The rotation of a rotation vector (Rodrigues). */
static void rotation_of(double out[3][3], const double v[3])
{
	double angle = vec_norm(v), s = angle > 1e-12 ? sin(angle) / angle : 1, c = angle > 1e-12 ? (1 - cos(angle)) / (angle * angle) : 0.5;
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++)
			out[i][j] = c * v[i] * v[j] + (i == j) * cos(angle);
	out[0][1] -= s * v[2];
	out[0][2] += s * v[1];
	out[1][0] += s * v[2];
	out[1][2] -= s * v[0];
	out[2][0] -= s * v[1];
	out[2][1] += s * v[0];
}

bool sums_move(struct pose *pose, struct sums *sums, double scale_max)
{
	double turn[3][3];
	if (!chol_solve(7, 7, &sums->a[0][0], sums->b))
		return false;
	rotation_of(turn, sums->b);
	mat_mul(pose->rotation, turn, pose->rotation);
	for (int k = 0; k < 3; k++)
		pose->shift[k] += sums->b[3 + k];
	pose->scale *= fmin(fmax(1 + sums->b[6], 0.8), 1.25);
	pose->scale = fmin(fmax(pose->scale, 1 / scale_max), scale_max);
	return true;
}

/* Whether the closest point lies on the boundary of the moving mesh: there it is no match. */
static bool at_end(const struct search *s, const struct closest_point *c)
{
	const int32_t *v = s->moving.faces[c->face];
	for (int k = 0; k < 3; k++)
		if (c->bary[k] > 1e-4f && !s->topology.boundary[v[k]])
			return false;
	return true;
}

static void match_one(struct sums *sums, struct search *s, int i, const struct pose *pose, double welsch)
{
	double at[3], normal[3], d[3], about[3];
	pose_place(at, pose, s->samples[i].at);
	mat_vec(normal, pose->rotation, s->samples[i].normal);
	float q[3] = { (float)at[0], (float)at[1], (float)at[2] }, n[3] = { (float)normal[0], (float)normal[1], (float)normal[2] };
	struct closest_point c = closest_find(s->scene, q, n, (float)s->conf->turn, INFINITY, s->face[i]);
	s->face[i] = c.face;
	if (c.face < 0 || at_end(s, &c))
		return;
	double m[3] = { c.normal[0], c.normal[1], c.normal[2] };
	for (int k = 0; k < 3; k++) {
		d[k] = (double)c.at[k] - at[k];
		about[k] = at[k] - pose->shift[k];
	}
	if (!(vec_dot(m, normal) > s->conf->facing))
		return;
	double weight = exp(-vec_dot(d, d) / (welsch * welsch)), across = vec_dot(m, d);
	sums_add(sums, about, d, m, weight);
	sums_add(sums, about, d, 0, 0.02 * weight);  // a little along the surface: else spheres and planes are singular
	sums->weight += weight;
	sums->square += weight * across * across;
}

void align_hold(struct sums *sums, const struct search *s, const struct pose *pose, double weight)
{
	for (int i = 0; i < s->n_held; i++) {
		double at[3], about[3], off[3];
		pose_place(at, pose, s->held[i].at);
		for (int k = 0; k < 3; k++) {
			about[k] = at[k] - pose->shift[k];
			off[k] = (double)s->moving.vertices[s->held[i].row][k] - at[k];
		}
		sums_add(sums, about, off, 0, weight / s->n_held);
	}
}

double align_held_off(const struct search *s, const struct pose *pose)
{
	double sum = 0;
	for (int i = 0; i < s->n_held; i++) {
		double at[3];
		pose_place(at, pose, s->held[i].at);
		for (int k = 0; k < 3; k++)
			sum += pow((double)s->moving.vertices[s->held[i].row][k] - at[k], 2);
	}
	return sum / (pose->scale * pose->scale);
}

double align_refine(struct pose *pose, double *rms, struct search *s, int rounds, const double welsch[2], int step)
{
	struct sums sums = { 0 };
	for (int i = 0; i < s->n; i++)
		s->face[i] = -1;
	for (int round = 0; round <= rounds; round++) {
		double at = rounds ? (double)round / rounds : 1;
		sums = (struct sums){ 0 };
		for (int i = 0; i < s->n; i += step)
			match_one(&sums, s, i, pose, welsch[0] * pow(welsch[1] / welsch[0], at));
		if (round == rounds)
			break;
		align_hold(&sums, s, pose, sums.weight);
		for (int k = 0; k < 7; k++)
			sums.a[k][k] += 1e-6 * s->n + (k == 6 ? 0.01 * sums.weight : 0);
		if (!(sums.weight > 6) || !sums_move(pose, &sums, s->conf->scale_max))
			break;
	}
	*rms = sums.weight > 0 ? sqrt(sums.square / sums.weight) : INFINITY;
	return s->n ? sums.weight / ((s->n + step - 1) / step) : 0;
}

double align_narrow(struct pose *pose, struct search *s, int step)
{
	enum { ROUNDS = 4 };
	const double fine[2] = { s->conf->welsch[1], s->conf->fine };
	double rms;
	return align_refine(pose, &rms, s, ROUNDS, fine, step);
}

void align_finish(struct best *b, struct search *s, const double welsch[2])
{
	b->matched = align_refine(&b->pose, &b->rms, s, s->conf->rounds, welsch, 1);
	struct pose narrow = b->pose;
	b->fine = align_narrow(&narrow, s, 1);
}
