#include "optics/lightpath.h"

#include <math.h>
#include <stdbool.h>

#include "math/vec.h"
#include "optics/lightpath_start.h"

/* One problem: P inside; outside a point C, or the unit direction w. */
struct path {
	const struct cornea *cornea;
	const double *P, *C, *w;  // C or w is null
	double reach;             // radius to which the surface is continued, mm
};

/* The chart of the surface: x and y. */
struct chart {
	double K[3], s;  // s = R − pz: the normal is (x, y, −s), the slopes are x/s and y/s
};

static struct chart chart_at(const struct path *path, double x, double y)
{
	double r = hypot(x, y), R = path->cornea->R, f = r > path->reach ? path->reach / r : 1;
	x *= f;
	y *= f;
	double r2 = x * x + y * y, s = sqrt(R * R - path->cornea->p * r2);
	return (struct chart){ { x, y, r2 / (R + s) }, s };
}

/* Unit direction from K to the light, and 1 / its distance (0 at infinity). */
static double outward(double u[3], const struct path *path, const double K[3])
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

/* L(b) − L(a) without cancellation: |CK| of a camera 10 km away has no digits to spare. */
static double length_change(const struct path *path, const double a[3], const double b[3])
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

/* Gradient and Hessian (xx, xy, yy) of L = |CK| + n |KP| over the chart. */
static void derivatives(double g[2], double H[3], const struct path *path, const struct chart *at)
{
	double n = path->cornea->n, p = path->cornea->p, u[3], v[3], out = outward(u, path, at->K), grad[3];
	vec_add(v, at->K, -1, path->P);
	double d = vec_norm(v), in = n / d;
	for (int i = 0; i < 3; i++) {
		v[i] /= d;
		grad[i] = n * v[i] - u[i];
	}
	double a = at->K[0] / at->s, b = at->K[1] / at->s, bend = grad[2] / at->s;
	double va = v[0] + a * v[2], vb = v[1] + b * v[2], ua = u[0] + a * u[2], ub = u[1] + b * u[2];
	g[0] = grad[0] + a * grad[2];
	g[1] = grad[1] + b * grad[2];
	H[0] = (in + out) * (1 + a * a) - in * va * va - out * ua * ua + bend * (1 + p * a * a);
	H[1] = (in + out) * a * b - in * va * vb - out * ua * ub + bend * p * a * b;
	H[2] = (in + out) * (1 + b * b) - in * vb * vb - out * ub * ub + bend * (1 + p * b * b);
}

/* Newton's step, made a descent step where L is not convex. */
static void newton_step(double step[2], const double g[2], const double H[3])
{
	double mean = 0.5 * (H[0] + H[2]), half = hypot(0.5 * (H[0] - H[2]), H[1]), least = mean - half;
	double lift = least < 1e-9 * (fabs(mean) + half) ? 1e-2 * (fabs(mean) + half) - least : 0;
	double a = H[0] + lift, c = H[2] + lift, det = a * c - H[1] * H[1];
	step[0] = (H[1] * g[1] - c * g[0]) / det;
	step[1] = (H[1] * g[0] - a * g[1]) / det;
}

/* Where the ray from P inside, in direction q, leaves the surface (continued past the equator). */
static struct chart leave(const struct path *path, const double q[3])
{
	const double *P = path->P, R = path->cornea->R, p = path->cornea->p;
	double A = q[0] * q[0] + q[1] * q[1] + p * q[2] * q[2], B = P[0] * q[0] + P[1] * q[1] + (p * P[2] - R) * q[2];
	double C = P[0] * P[0] + P[1] * P[1] + P[2] * (p * P[2] - 2 * R), root = sqrt(fmax(B * B - A * C, 0));
	double t = B > 0 ? -C / (B + root) : (root - B) / A;
	if (!(t < 1e3 * R))
		t = 1e3 * R;
	return chart_at(path, P[0] + t * q[0], P[1] + t * q[1]);
}

/* Direction inside, from P's side towards K, of light that leaves K in unit direction u; smooth past 90 degrees.
 * Its length is n. */
static void bend_out(double q[3], const struct path *path, const struct chart *at, const double u[3])
{
	double n = path->cornea->n, G[3] = { at->K[0], at->K[1], -at->s }, a = vec_dot(u, G), g2 = vec_dot(G, G);
	vec_add(q, u, (sqrt(a * a + (n * n - 1) * g2) - a) / g2, G);
}

/* Closed form: along the outgoing direction bent towards the axis, refracted there, and once more. */
static struct chart first_guess(const struct path *path)
{
	double u[3], q[3];
	outward(u, path, path->P);
	q[0] = u[0];
	q[1] = u[1];
	q[2] = u[2] - LIGHTPATH_BEND;
	struct chart at = leave(path, q);
	outward(u, path, at.K);
	bend_out(q, path, &at, u);
	return leave(path, q);
}

static bool descend(struct chart *at, const struct path *path)
{
	for (int i = 0; i < 60; i++) {
		double g[2], H[3], step[2];
		derivatives(g, H, path, at);
		newton_step(step, g, H);
		double size = hypot(step[0], step[1]), slope = step[0] * g[0] + step[1] * g[1], k = 1;
		if (!isfinite(size))
			return false;
		if (size > 2)
			k = 2 / size;
		struct chart next = chart_at(path, at->K[0] + k * step[0], at->K[1] + k * step[1]);
		// Below 1e-7 mm L no longer tells the points apart; Newton's step is right there.
		while (size > 1e-7 && k > 1e-6 && !(length_change(path, at->K, next.K) <= 1e-4 * k * slope)) {
			k *= 0.4;
			next = chart_at(path, at->K[0] + k * step[0], at->K[1] + k * step[1]);
		}
		double moved = hypot(next.K[0] - at->K[0], next.K[1] - at->K[1]);
		*at = next;
		if (moved < 1e-13)
			return true;
		if (size < 1e-9 && i > 2)
			return true;
	}
	return true;
}

static enum lightpath_status solve(double K[3], const struct path *path)
{
	for (int i = 0; i < 3; i++)
		K[i] = 0;
	const double *P = path->P, *C = path->C, R = path->cornea->R, p = path->cornea->p;
	if (!(P[0] * P[0] + P[1] * P[1] + P[2] * (p * P[2] - 2 * R) < 0))
		return LIGHTPATH_NONE;
	if (C && !(C[0] * C[0] + C[1] * C[1] + C[2] * (p * C[2] - 2 * R) > 0))
		return LIGHTPATH_NONE;
	if (!C && !isfinite(path->w[0] + path->w[1] + path->w[2]))
		return LIGHTPATH_NONE;
	struct chart at = first_guess(path);
	if (!descend(&at, path))
		return LIGHTPATH_NONE;
	for (int i = 0; i < 3; i++)
		K[i] = at.K[i];
	double u[3];
	outward(u, path, K);
	if (u[0] * K[0] + u[1] * K[1] - u[2] * at.s < 0)
		return LIGHTPATH_GRAZING;
	return hypot(K[0], K[1]) > cornea_edge(path->cornea) * (1 - 1e-9) ? LIGHTPATH_BEYOND_RIM : LIGHTPATH_OK;
}

enum lightpath_status lightpath_solve(double K[3], const struct cornea *cornea, const double P[3], const double C[3])
{
	return solve(K, &(struct path){ cornea, P, C, 0, lightpath_reach(cornea) });
}

enum lightpath_status lightpath_solve_directional(double K[3], const struct cornea *cornea, const double P[3],
                                                  const double w[3])
{
	return solve(K, &(struct path){ cornea, P, 0, w, lightpath_reach(cornea) });
}

double lightpath_gain(const struct cornea *cornea, const double P[3], const double w[3], const double K[3])
{
	double R = cornea->R, p = cornea->p, s = R - p * K[2];
	struct path path = { cornea, P, 0, w, lightpath_reach(cornea) };
	struct chart at = { { K[0], K[1], K[2] }, s };
	double g[2], H[3], v[3], N[3];
	derivatives(g, H, &path, &at);
	vec_add(v, K, -1, P);
	double d = vec_norm(v), a = K[0] / s, b = K[1] / s;
	for (int i = 0; i < 3; i++)
		v[i] /= d;
	// P moves in its plane: dK = -H⁻¹ (∂g/∂P) dP, with ∂g/∂P = -(n/d) rows of (e + slope z)ᵀ (I − v vᵀ).
	double va = v[0] + a * v[2], vb = v[1] + b * v[2];
	double M[2][2] = { { 1 - va * v[0], -va * v[1] }, { -vb * v[0], 1 - vb * v[1] } }, f = cornea->n / d;
	double area = f * f * (M[0][0] * M[1][1] - M[0][1] * M[1][0]) / (H[0] * H[2] - H[1] * H[1]);
	cornea_normal(N, cornea, K);
	double cos_i = vec_dot(w, N);
	return cos_i > 0 ? fresnel_transmittance(cos_i, 1, cornea->n) * cos_i * fabs(area / N[2]) : 0;
}
