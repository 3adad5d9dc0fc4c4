#include "register/eyes.h"

#include <math.h>
#include <stdlib.h>

#include "base/mem.h"
#include "math/vec.h"
#include "mesh/topology.h"

enum { LEAST_VERTICES = 20 };

struct ball {
	double center[3], radius;
};

/* Whether a connected piece is a ball: its vertices lie all round its middle at much the same distance. Sets ball. */
static bool is_ball(struct ball *ball, const struct mesh *mesh, const int *piece, int which)
{
	// A cornea stands out by a tenth; lashes, lids and teeth spread over more than a third.
	const double spread_max = 0.15, open_max = 0.35;
	double low[3] = { INFINITY, INFINITY, INFINITY }, high[3] = { -INFINITY, -INFINITY, -INFINITY };
	double sum = 0, square = 0, middle[3] = { 0 };
	int n = 0;
	for (int i = 0; i < mesh->n_vertices; i++)
		for (int k = 0; k < 3 && piece[i] == which; k++) {
			low[k] = fmin(low[k], (double)mesh->vertices[i][k]);
			high[k] = fmax(high[k], (double)mesh->vertices[i][k]);
		}
	for (int k = 0; k < 3; k++)
		ball->center[k] = 0.5 * (low[k] + high[k]);
	for (int i = 0; i < mesh->n_vertices; i++) {
		if (piece[i] != which)
			continue;
		double d[3];
		for (int k = 0; k < 3; k++)
			d[k] = (double)mesh->vertices[i][k] - ball->center[k];
		double r = vec_norm(d);
		sum += r;
		square += r * r;
		vec_add(middle, middle, 1 / fmax(r, 1e-12), d);
		n++;
	}
	if (n < LEAST_VERTICES)
		return false;
	ball->radius = sum / n;
	return sqrt(fmax(0, square / n - ball->radius * ball->radius)) < spread_max * ball->radius && vec_norm(middle) / n < open_max;
}

bool eyes_of_target(double center[2][3], double *radius, const struct mesh *target)
{
	enum { MOST = 64 };
	struct ball balls[MOST];
	int *piece = mesh_pieces(target->n_vertices, target->n_faces, target->faces), n = 0;
	for (int i = 0; i < target->n_vertices && n < MOST; i++)
		n += piece[i] == i && is_ball(&balls[n], target, piece, i);
	*radius = 0;
	for (int i = 0; i < n; i++)
		for (int j = 0; j < n; j++) {
			double d[3], mean = 0.5 * (balls[i].radius + balls[j].radius);
			vec_add(d, balls[i].center, -1, balls[j].center);
			double apart = vec_norm(d);
			// 63 mm between eyes of 12 mm: 5 radii; of cartoons less. The largest such pair: irises and lenses lie inside.
			bool pair = (d[0] > 0 || (d[0] == 0 && i < j)) && apart > 2 * mean && apart < 10 * mean && fabs(balls[i].radius - balls[j].radius) < 0.1 * mean;
			if (pair && mean > *radius) {
				*radius = mean;
				for (int k = 0; k < 3; k++) {
					center[0][k] = balls[i].center[k];
					center[1][k] = balls[j].center[k];
				}
			}
		}
	free(piece);
	return *radius > 0;
}

static int nearest(const struct mesh *mesh, const double p[3])
{
	int best = -1;
	double least = INFINITY;
	for (int i = 0; i < mesh->n_vertices; i++) {
		double d[3];
		for (int k = 0; k < 3; k++)
			d[k] = (double)mesh->vertices[i][k] - p[k];
		double square = vec_dot(d, d);
		if (square < least) {
			least = square;
			best = i;
		}
	}
	return best;
}

/* The direction in which the skin near an eyeball lies: forward. False: it lies all round, or there is none. */
static bool ahead_of(double ahead[3], const struct mesh_part *part, const double center[3], double radius)
{
	double sum[3] = { 0 };
	int n = 0;
	for (int i = 0; i < part->mesh.n_vertices; i++) {
		double d[3];
		for (int k = 0; k < 3; k++)
			d[k] = (double)part->mesh.vertices[i][k] - center[k];
		double r = vec_norm(d);
		if (r < 1.3 * radius && r > 0) {
			vec_add(sum, sum, 1 / r, d);
			n++;
		}
	}
	if (!n || !(vec_norm(sum) > 0.2 * n))
		return false;
	vec_unit(ahead, sum);
	return true;
}

/* The head's axes in the target's frame, as columns: x from the right to the left eye, y up, z ahead. */
static bool axes_of(double axes[3][3], const struct mesh_part *part, const double left[3], const double right[3], double radius)
{
	double a[3], b[3], x[3], y[3], z[3];
	if (!ahead_of(a, part, left, radius) || !ahead_of(b, part, right, radius) || !(vec_dot(a, b) > 0.5))
		return false;
	vec_add(x, left, -1, right);
	vec_unit(x, x);
	vec_add(z, a, 1, b);
	vec_add(z, z, -vec_dot(z, x), x);
	if (!(vec_norm(z) > 0.7))
		return false;
	vec_unit(z, z);
	vec_cross(y, z, x);
	for (int k = 0; k < 3; k++) {
		axes[k][0] = x[k];
		axes[k][1] = y[k];
		axes[k][2] = z[k];
	}
	return true;
}

bool eyes_landmarks(struct nricp_landmarks *out, const struct mesh_part *part, const double target_eye[2][3], double target_radius,
                    bool swapped, const struct mesh *subject, const double subject_eye[2][3])
{
	// The lids' middles and corners from the eyeball's centre, in its radii; a human eyeball has a radius of 12 mm.
	static const double places[][3] = { { 0, 0.6, 1 }, { 0, -0.6, 1 }, { 1, 0, 0.7 }, { -1, 0, 0.7 } };
	const double subject_radius = 12;
	double axes[3][3];
	*out = (struct nricp_landmarks){ 0 };
	if (!axes_of(axes, part, target_eye[swapped], target_eye[!swapped], target_radius))
		return false;
	int *rows = mem_new(4 * COUNT(places), sizeof *rows), *fixed = rows + 2 * COUNT(places);
	for (int e = 0; e < 2; e++)
		for (int i = 0; i < COUNT(places); i++) {
			double p[3], q[3];
			mat_vec(p, axes, places[i]);
			vec_add(p, target_eye[e ^ swapped], target_radius, p);
			vec_add(q, subject_eye[e], subject_radius, places[i]);
			rows[out->n] = part->row[nearest(&part->mesh, p)];
			fixed[out->n++] = nearest(subject, q);
		}
	out->moving = rows;
	out->fixed = fixed;
	return true;
}

double eyes_below(const struct mesh_part *part, const double target_eye[2][3], double target_radius, bool swapped)
{
	const double *left = target_eye[swapped], *right = target_eye[!swapped];
	double axes[3][3], all = 0, below = 0;
	if (!axes_of(axes, part, left, right, target_radius))
		return NAN;
	double *area = mesh_vertex_areas(&part->mesh);
	for (int i = 0; i < part->mesh.n_vertices; i++) {
		double up = 0;
		for (int k = 0; k < 3; k++)
			up += axes[k][1] * ((double)part->mesh.vertices[i][k] - 0.5 * (left[k] + right[k]));
		all += area[i];
		below += up < 0 ? area[i] : 0;
	}
	free(area);
	return all > 0 ? below / all : NAN;
}

int eyes_upright(const double below[2], const double fine[2], double least, double nearly)
{
	for (int k = 0; k < 2; k++)
		if (fine[k] > nearly * fine[!k] && below[k] > least)
			return k;
	return -1;
}
