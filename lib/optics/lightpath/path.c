#include "optics/lightpath/path.h"

#include <math.h>

#include "math/vec.h"

struct chart chart_at(const struct cornea *cornea, double x, double y)
{
	double rho2 = x * x + y * y, tau = 2 / (1 + cornea->p * rho2), t = cornea->R * tau;
	return (struct chart){ x, y, tau, rho2, { t * x, t * y, t * rho2 } };
}

static struct chart chart_of(const struct cornea *cornea, const double K[3])
{
	double t = 2 * cornea->R - cornea->p * K[2];
	return chart_at(cornea, K[0] / t, K[1] / t);
}

struct chart chart_moved(const struct cornea *cornea, const struct chart *at, const double step[2])
{
	double t = cornea->R * at->tau;
	return chart_at(cornea, at->x + step[0] / t, at->y + step[1] / t);
}

double path_outward(double u[3], const struct path *path, const double K[3])
{
	if (path->w) {
		for (int i = 0; i < 3; i++)
			u[i] = path->w[i];
		return 0;
	}
	vec_add(u, path->C, -1, K);
	double d = vec_norm(u);
	for (int i = 0; i < 3; i++)
		u[i] /= d;
	return 1 / d;
}

/* Differences of lengths are computed directly: |CK| of a camera 10 km away has no digits to spare. */
double path_length_change(const struct path *path, const double a[3], const double b[3])
{
	double ab[3], pa[3], pb[3], sum[3], change;
	vec_add(ab, b, -1, a);
	vec_add(pa, a, -1, path->P);
	vec_add(pb, b, -1, path->P);
	vec_add(sum, pa, 1, pb);
	change = path->cornea->n * vec_dot(ab, sum) / (vec_norm(pa) + vec_norm(pb));
	if (path->w)
		return change - vec_dot(path->w, ab);
	double ca[3], cb[3];
	vec_add(ca, a, -1, path->C);
	vec_add(cb, b, -1, path->C);
	vec_add(sum, ca, 1, cb);
	return change + vec_dot(ab, sum) / (vec_norm(ca) + vec_norm(cb));
}

/* Components of a along the two tangents. */
static void along(double out[2], const struct path *path, const struct chart *at, const double a[3])
{
	double m = at->tau * (a[2] - path->cornea->p * (at->x * a[0] + at->y * a[1]));
	out[0] = a[0] + at->x * m;
	out[1] = a[1] + at->y * m;
}

void path_derivatives(double g[2], double H[3], const struct path *path, const struct chart *at)
{
	double n = path->cornea->n, p = path->cornea->p, t = path->cornea->R * at->tau;
	double u[3], v[3], grad[3], va[2], ua[2], out = path_outward(u, path, at->K);
	vec_add(v, at->K, -1, path->P);
	double d = vec_norm(v), in = n / d, x = at->x, y = at->y;
	for (int i = 0; i < 3; i++) {
		v[i] /= d;
		grad[i] = n * v[i] - u[i];
	}
	along(g, path, at, grad);
	along(va, path, at, v);
	along(ua, path, at, u);
	// The surface's own curvature, grad·m / t, and the tangents' products δ + x_i x_j (|m|² − 2 p tau).
	double bend = in + out + at->tau * (grad[2] - p * (x * grad[0] + y * grad[1])) / t;
	double m2 = (in + out) * at->tau * (at->tau * (1 + p * p * at->rho2) - 2 * p);
	H[0] = bend + m2 * x * x - in * va[0] * va[0] - out * ua[0] * ua[0];
	H[1] = m2 * x * y - in * va[0] * va[1] - out * ua[0] * ua[1];
	H[2] = bend + m2 * y * y - in * va[1] * va[1] - out * ua[1] * ua[1];
}

void path_inside(double q[3], const struct path *path, const struct chart *at, const double u[3])
{
	const struct cornea *c = path->cornea;
	double n = c->n, G[3] = { at->K[0], at->K[1], c->p * at->K[2] - c->R }, a = vec_dot(u, G), g2 = vec_dot(G, G);
	vec_add(q, u, (sqrt(a * a + (n * n - 1) * g2) - a) / g2, G);
}

struct chart path_leave(const struct path *path, const double q[3])
{
	const double *P = path->P, R = path->cornea->R, p = path->cornea->p;
	double A = q[0] * q[0] + q[1] * q[1] + p * q[2] * q[2], B = P[0] * q[0] + P[1] * q[1] + (p * P[2] - R) * q[2];
	double C = P[0] * P[0] + P[1] * P[1] + P[2] * (p * P[2] - 2 * R), root = sqrt(fmax(B * B - A * C, 0)), K[3];
	double t = B > 0 ? -C / (B + root) : (root - B) / A;
	vec_add(K, P, fmin(t, 1e3 * R), q);  // a ray along the axis never leaves a paraboloid at its open end
	return chart_of(path->cornea, K);
}

/* Derivative of the unit direction inside as K moves along tangent T. */
static void turn(double dq[3], const struct path *path, const struct chart *at, const double u[3], double out,
                 const double T[3])
{
	const struct cornea *c = path->cornea;
	double G[3] = { at->K[0], at->K[1], c->p * at->K[2] - c->R }, dG[3] = { T[0], T[1], c->p * T[2] }, du[3];
	double a = vec_dot(u, G), g2 = vec_dot(G, G), m = c->n * c->n - 1, S = sqrt(a * a + m * g2), f = (S - a) / g2;
	double uT = vec_dot(u, T);
	for (int i = 0; i < 3; i++)
		du[i] = out * (uT * u[i] - T[i]);
	double da = vec_dot(du, G) + vec_dot(u, dG), dg2 = 2 * vec_dot(G, dG), dS = (a * da + 0.5 * m * dg2) / S;
	double df = (dS - da - f * dg2) / g2;
	for (int i = 0; i < 3; i++)
		dq[i] = (du[i] + df * G[i] + f * dG[i]) / c->n;
}

void path_miss(double miss[2], double J[2][2], const struct path *path, const struct chart *at)
{
	const struct cornea *c = path->cornea;
	double u[3], q[3], v[3], out = path_outward(u, path, at->K), m[3] = { -c->p * at->x, -c->p * at->y, 1 };
	path_inside(q, path, at, u);
	vec_add(v, at->K, -1, path->P);
	// Two directions across the ray: its cross product with the x or y axis, whichever is more nearly perpendicular to it, and the third.
	int least = fabs(q[0]) < fabs(q[1]) ? 0 : 1;
	double e[3] = { least == 0, least == 1, 0 }, B[2][3], t = vec_dot(v, q) / c->n;
	vec_unit(q, q);
	vec_cross(B[0], q, e);
	vec_unit(B[0], B[0]);
	vec_cross(B[1], q, B[0]);
	for (int k = 0; k < 2; k++) {
		double along_m = at->tau * (k ? at->y : at->x), dq[3];
		double T[3] = { (k == 0) + along_m * m[0], (k == 1) + along_m * m[1], along_m };
		turn(dq, path, at, u, out, T);
		miss[k] = vec_dot(B[k], v);
		for (int i = 0; i < 2; i++)
			J[i][k] = vec_dot(B[i], T) - t * vec_dot(B[i], dq);
	}
}

void path_polish(struct chart *at, const struct path *path)
{
	for (int i = 0; i < 2; i++) {
		double r[2], J[2][2];
		path_miss(r, J, path, at);
		double det = J[0][0] * J[1][1] - J[0][1] * J[1][0];
		double step[2] = { (J[0][1] * r[1] - J[1][1] * r[0]) / det, (J[1][0] * r[0] - J[0][0] * r[1]) / det };
		if (!(fabs(step[0]) + fabs(step[1]) < 1e-5))
			return;
		*at = chart_moved(path->cornea, at, step);
	}
}

bool path_is_sound(const struct path *path)
{
	const double *P = path->P, *C = path->C, R = path->cornea->R, p = path->cornea->p;
	if (!(P[0] * P[0] + P[1] * P[1] + P[2] * (p * P[2] - 2 * R) < 0))
		return false;
	if (C)
		return C[0] * C[0] + C[1] * C[1] + C[2] * (p * C[2] - 2 * R) > 0 && isfinite(C[0] + C[1] + C[2]);
	return isfinite(path->w[0] + path->w[1] + path->w[2]);
}
