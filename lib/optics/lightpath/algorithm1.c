#include <math.h>

#include "math/vec.h"
#include "optics/lightpath/lightpath.h"

/* The paper's IntersectCornea(P, towards): the point where the ray from P inside leaves the quadric. */
static void leave(double K[3], const struct cornea *c, const double P[3], const double towards[3])
{
	double q[3];
	vec_add(q, towards, -1, P);
	vec_unit(q, q);
	double A = q[0] * q[0] + q[1] * q[1] + c->p * q[2] * q[2], B = vec_dot(P, q) + ((c->p - 1) * P[2] - c->R) * q[2];
	double C = P[0] * P[0] + P[1] * P[1] + P[2] * (c->p * P[2] - 2 * c->R), root = sqrt(B * B - A * C);
	vec_add(K, P, B > 0 ? -C / (B + root) : (root - B) / A, q);
}

/* Gradient of L = |CK| + n |KP| projected onto the plane of normal N (eq. 7). */
static void gradient(double g[3], const struct cornea *c, const double P[3], const double C[3], const double K[3],
                     const double N[3])
{
	double u[3], v[3];
	vec_add(u, K, -1, C);
	vec_add(v, K, -1, P);
	double du = vec_norm(u), dv = vec_norm(v);
	for (int i = 0; i < 3; i++)
		g[i] = u[i] / du + c->n * v[i] / dv;
	vec_add(g, g, -vec_dot(g, N), N);
}

/* Gradient descent on one tangent plane, eq. 6. */
static void descend(double K[3], const struct cornea *c, const double P[3], const double C[3],
                    const struct algorithm1_conf *conf)
{
	double N[3], g[3];
	cornea_normal(N, c, K);
	for (int j = 0; j < conf->max_inner; j++) {
		gradient(g, c, P, C, K, N);
		double norm = vec_norm(g), alpha = conf->alpha / ((j + 1) * norm);
		if (!(norm > 0) || alpha < conf->eps_inner)
			return;
		vec_add(K, K, -alpha, g);
	}
}

enum lightpath_status lightpath_algorithm1(double K[3], const struct cornea *cornea, const double P[3],
                                           const double C[3], const struct algorithm1_conf *conf)
{
	leave(K, cornea, P, C);
	for (int i = 0; i < conf->max_outer; i++) {
		double plane[3] = { K[0], K[1], K[2] }, moved[3];
		descend(plane, cornea, P, C, conf);
		leave(K, cornea, P, plane);
		vec_add(moved, K, -1, plane);
		if (vec_norm(moved) < conf->eps_outer)
			break;
	}
	double u[3], N[3];
	vec_add(u, C, -1, K);
	cornea_normal(N, cornea, K);
	if (!isfinite(K[0] + K[1] + K[2]))
		return LIGHTPATH_NONE;
	if (vec_dot(u, N) < 0)
		return LIGHTPATH_GRAZING;
	return hypot(K[0], K[1]) > cornea->rim ? LIGHTPATH_BEYOND_RIM : LIGHTPATH_OK;
}
