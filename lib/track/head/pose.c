#include "track/head/pose.h"

#include <math.h>
#include <string.h>

#include "math/chol.h"
#include "math/vec.h"

enum { P = 6, STEPS = 30 };

void head_fick(double fick[3], const double m[4][4])
{
	// Against a head that faces the camera: its x is the camera's, its y and z point the other way.
	fick[0] = atan2(m[0][2], -m[2][2]);
	fick[1] = asin(fmin(fmax(-m[1][2], -1), 1));
	fick[2] = atan2(-m[1][0], -m[1][1]);
}

void head_from(double out[3], const double m[4][4], const double head[3])
{
	double t[3];
	for (int r = 0; r < 3; r++)
		t[r] = m[r][0] * head[0] + m[r][1] * head[1] + m[r][2] * head[2] + m[r][3];
	memcpy(out, t, sizeof t);
}

void head_to(double out[3], const double m[4][4], const double cam[3])
{
	double t[3] = { cam[0] - m[0][3], cam[1] - m[1][3], cam[2] - m[2][3] }, h[3];
	for (int c = 0; c < 3; c++)
		h[c] = m[0][c] * t[0] + m[1][c] * t[1] + m[2][c] * t[2];
	memcpy(out, h, sizeof h);
}

bool head_project(double px[2], const struct camera *camera, const double m[4][4], const double head[3])
{
	double p[3];
	head_from(p, m, head);
	return camera_project(px, camera, p);
}

/* Rotation by |w| about w. */
static void turn(double R[3][3], const double w[3])
{
	double angle = vec_norm(w), s = angle > 1e-9 ? sin(angle) / angle : 1, c = angle > 1e-9 ? (1 - cos(angle)) / (angle * angle) : 0.5;
	double K[3][3] = { { 0, -w[2], w[1] }, { w[2], 0, -w[0] }, { -w[1], w[0], 0 } }, KK[3][3];
	mat_mul(KK, K, K);
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++)
			R[i][j] = (i == j) + s * K[i][j] + c * KK[i][j];
}

/* The rotation vector of a R b^T. */
static void turned(double w[3], const double a[4][4], const double b[4][4])
{
	double R[3][3];
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++)
			R[i][j] = a[i][0] * b[j][0] + a[i][1] * b[j][1] + a[i][2] * b[j][2];
	double v[3] = { R[2][1] - R[1][2], R[0][2] - R[2][0], R[1][0] - R[0][1] };
	double s = 0.5 * vec_norm(v), c = 0.5 * (R[0][0] + R[1][1] + R[2][2] - 1), angle = atan2(s, c);
	for (int i = 0; i < 3; i++)
		w[i] = s > 1e-12 ? 0.5 * v[i] * angle / s : 0;
}

void head_moved(double out[4][4], const double m[4][4], const double d[P], const double pivot[3])
{
	double R[3][3], now[3][3], was[3][3], arm[3];
	turn(R, d);
	for (int i = 0; i < 3; i++) {
		memcpy(was[i], m[i], sizeof was[i]);
		arm[i] = m[i][3] - pivot[i];
	}
	mat_mul(now, R, was);
	mat_vec(arm, R, arm);
	memcpy(out, m, 16 * sizeof(double));
	for (int i = 0; i < 3; i++) {
		memcpy(out[i], now[i], sizeof now[i]);
		out[i][3] = pivot[i] + arm[i] + d[3 + i];
	}
}

/* Residuals (2, or 1 along a line's normal) and their Jacobian by the six parameters. The derivative of the distortion is left
 * out, which costs a step and no accuracy. */
static int look(double r[2], double J[2][P], const struct head_sight *s, const double m[4][4], const struct camera *camera,
                const double pivot[3])
{
	double p[3], px[2], D[2][P];
	head_from(p, m, s->head);
	if (!camera_project(px, camera, p))
		return 0;
	double f = camera->focal_px / p[2], x = p[0] / p[2], y = p[1] / p[2];
	double a[3] = { p[0] - pivot[0], p[1] - pivot[1], p[2] - pivot[2] };
	// motion of the point: w x a + shift
	double du[3] = { f, 0, -f * x }, dv[3] = { 0, f, -f * y };
	vec_cross(D[0], a, du);
	vec_cross(D[1], a, dv);
	memcpy(D[0] + 3, du, sizeof du);
	memcpy(D[1] + 3, dv, sizeof dv);
	double e[2] = { px[0] - s->px[0], px[1] - s->px[1] };
	for (int k = 0; k < 2; k++) {
		r[k] = s->line ? s->normal[0] * e[0] + s->normal[1] * e[1] : e[k];
		for (int j = 0; j < P; j++)
			J[k][j] = s->line ? s->normal[0] * D[0][j] + s->normal[1] * D[1][j] : D[k][j];
	}
	return s->line ? 1 : 2;
}

/* Cost of a pose; fills the normal equations where H is not null. */
static double sum(double H[P][P], double g[P], double *weight, const double m[4][4], int n, const struct head_sight *s,
                  const struct camera *camera, double robust, const double pivot[3])
{
	double cost = 0;
	*weight = 0;
	for (int i = 0; i < n; i++) {
		double r[2], J[2][P];
		int rows = s[i].weight > 0 ? look(r, J, &s[i], m, camera, pivot) : 0;
		double e2 = (rows > 0 ? r[0] * r[0] : 0) + (rows > 1 ? r[1] * r[1] : 0);
		double k = isinf(robust) || s[i].sure ? 1 : 1 / (1 + e2 / (robust * robust)), w = s[i].weight * k * k;
		cost += rows ? s[i].weight * k * e2 : 0;
		*weight += rows ? s[i].weight : 0;
		for (int a = 0; H && a < rows; a++)
			for (int c = 0; c < P; c++) {
				g[c] -= w * J[a][c] * r[a];
				for (int d = 0; d <= c; d++)  // the lower triangle is what is solved
					H[c][d] += w * J[a][c] * J[a][d];
			}
	}
	return cost;
}

void head_motion(double e[P], const double m[4][4], const double from[4][4], const double pivot[3])
{
	double head[3];
	turned(e, m, from);
	head_to(head, from, pivot);
	head_from(head, m, head);
	for (int i = 0; i < 3; i++)
		e[3 + i] = head[i] - pivot[i];
}

/* The same with the shift of the point that is at the pivot afterwards, which decouples it from a further rotation about the pivot. */
static void off_prior(double e[P], const double m[4][4], const double from[4][4], const double pivot[3])
{
	double head[3];
	turned(e, m, from);
	head_to(head, m, pivot);
	head_from(head, from, head);
	for (int i = 0; i < 3; i++)
		e[3 + i] = pivot[i] - head[i];
}

/* The cost of a pose by a form. Its motion from there follows that about `pivot`: a turn w about that shifts the form's pivot by w x (pivot - that), too. */
static double formed(double H[P][P], double g[P], const double m[4][4], const struct head_form *f, const double pivot[3])
{
	double d[P], x[P], J[P][P] = { { 0 } }, arm[3], cost = 0;
	head_motion(d, m, f->cam_from_head, f->pivot);
	for (int k = 0; k < 3; k++)
		arm[k] = f->pivot[k] + d[3 + k] - pivot[k];
	const double cross[3][3] = { { 0, arm[2], -arm[1] }, { -arm[2], 0, arm[0] }, { arm[1], -arm[0], 0 } };  // w x arm
	for (int k = 0; k < P; k++) {
		J[k][k] = 1;
		x[k] = d[k] - f->best[k];
	}
	for (int k = 0; k < 3; k++)
		memcpy(J[3 + k], cross[k], sizeof cross[k]);
	for (int k = 0; k < P; k++) {
		double row[P] = { 0 }, off = 0;  // info J, info x
		for (int l = 0; l < P; l++) {
			off += f->info[k][l] * x[l];
			for (int c = 0; c < P; c++)
				row[c] += f->info[k][l] * J[l][c];
		}
		cost += x[k] * off;
		for (int a = 0; H && a < P; a++) {
			g[a] -= J[k][a] * off;
			for (int c = 0; c < P; c++)
				H[a][c] += J[k][a] * row[c];
		}
	}
	return cost;
}

static double expect(double H[P][P], double g[P], const double m[4][4], const struct head_prior *prior, const double pivot[3])
{
	double e[P], cost = 0;
	if (!prior)
		return 0;
	off_prior(e, m, prior->cam_from_head, pivot);
	for (int i = 0; i < P; i++) {
		double w = 1 / (prior->sigma[i] * prior->sigma[i]);
		cost += w * e[i] * e[i];
		if (H) {
			H[i][i] += w;
			g[i] -= w * e[i];
		}
	}
	return cost + (prior->form ? formed(H, g, m, prior->form, pivot) : 0);
}

/* Where the points are, by weight: about it rotations and shifts hardly depend on each other. Returns false without any. */
static bool middle(double pivot[3], const double m[4][4], int n, const struct head_sight *s)
{
	double total = 0;
	memset(pivot, 0, 3 * sizeof *pivot);
	for (int i = 0; i < n; i++) {
		double p[3];
		head_from(p, m, s[i].head);
		vec_add(pivot, pivot, s[i].weight, p);
		total += s[i].weight;
	}
	for (int k = 0; k < 3; k++)
		pivot[k] /= total;
	return total > 0;
}

bool head_pose_sigma(double turn[3], const double m[4][4], int n, const struct head_sight *s, const struct camera *camera, double robust,
                     const struct head_prior *prior)
{
	double H[P][P] = { { 0 } }, g[P] = { 0 }, pivot[3], weight;
	if (!middle(pivot, m, n, s))
		return false;
	sum(H, g, &weight, m, n, s, camera, robust, pivot);
	expect(H, g, m, prior, pivot);
	for (int k = 0; k < 3; k++) {
		double a[P][P], e[P] = { 0 };
		e[k] = 1;
		memcpy(a, H, sizeof a);
		if (!chol_solve(P, P, &a[0][0], e))
			return false;
		turn[k] = sqrt(e[k]);
	}
	return true;
}

double head_pose_cost(const double m[4][4], int n, const struct head_sight *s, const struct camera *camera, double robust, const struct head_prior *prior)
{
	double pivot[3], weight;
	return middle(pivot, m, n, s) ? sum(0, 0, &weight, m, n, s, camera, robust, pivot) + expect(0, 0, m, prior, pivot) : 0;
}

/* A pose's cost and the normal equations there. */
struct normal {
	double H[P][P], g[P], cost;
};

static void normal_at(struct normal *e, double *weight, const double m[4][4], int n, const struct head_sight *s, const struct camera *camera, double robust,
                      const struct head_prior *prior, const double pivot[3])
{
	*e = (struct normal){ 0 };
	e->cost = sum(e->H, e->g, weight, m, n, s, camera, robust, pivot);
	e->cost += expect(e->H, e->g, m, prior, pivot);
}

double head_pose_fit(double cam_from_head[4][4], int n, const struct head_sight *s, const struct camera *camera, double robust,
                     const struct head_prior *prior)
{
	double m[4][4], pivot[3], weight, damp = 1e-9;
	struct normal here, there;
	memcpy(m, cam_from_head, sizeof m);
	if (!middle(pivot, m, n, s))
		return NAN;
	normal_at(&here, &weight, m, n, s, camera, robust, prior, pivot);
	for (int it = 0; it < STEPS; it++) {
		double H[P][P], g[P], next[4][4];
		memcpy(H, here.H, sizeof H);
		memcpy(g, here.g, sizeof g);
		for (int k = 0; k < P; k++)
			H[k][k] *= 1 + damp;
		if (!chol_solve(P, P, &H[0][0], g))
			return NAN;
		head_moved(next, m, g, pivot);
		normal_at(&there, &weight, next, n, s, camera, robust, prior, pivot);
		double step = fmax(vec_norm(g) * 100, vec_norm(g + 3));
		if (there.cost < here.cost) {
			bool small = here.cost - there.cost < 1e-7 * here.cost;
			memcpy(m, next, sizeof m);
			here = there;
			damp = fmax(0.1 * damp, 1e-9);
			if (small)
				break;
		} else {
			if (step < 1e-6 || damp > 1e6)
				break;
			damp = fmax(10 * damp, 1e-5);
		}
	}
	double one = sum(0, 0, &weight, m, n, s, camera, INFINITY, pivot);
	memcpy(cam_from_head, m, sizeof m);
	return sqrt(one / fmax(weight, 1e-300));
}
