#include "light_case.h"

#include <math.h>

typedef long double real;

double rng_uniform(struct rng *rng, double low, double high)
{
	// splitmix64
	uint64_t z = rng->state += 0x9e3779b97f4a7c15u;
	z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
	z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
	return low + (high - low) * ((z ^ (z >> 31)) >> 11) * 0x1p-53;
}

static real dot(const real a[3], const real b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void normal_at(real N[3], const struct cornea *c, const real K[3])
{
	real g[3] = { K[0], K[1], c->p * K[2] - c->R }, length = sqrtl(dot(g, g));
	for (int i = 0; i < 3; i++)
		N[i] = g[i] / length;
}

static real depth_at(const struct cornea *c, real r2)
{
	return r2 / (c->R + sqrtl((real)c->R * c->R - c->p * r2));
}

static void draw_cornea(struct cornea *c, struct rng *rng, bool any)
{
	*c = (struct cornea){ .R = 7.8, .p = 0.75, .n = 1.336, .rim = 5.85 };
	if (!any)
		return;
	c->R = rng_uniform(rng, 5, 12);
	c->p = rng_uniform(rng, 0, 1) < 0.05 ? 0 : rng_uniform(rng, 0, 2);
	double kind = rng_uniform(rng, 0, 1);
	c->n = kind < 0.05 ? 1 : kind < 0.15 ? 1 + pow(10, rng_uniform(rng, -12, -1)) : rng_uniform(rng, 1.01, 2);
	c->rim = fmin(rng_uniform(rng, 4, 8), 0.98 * c->R / sqrt(fmax(c->p, 0.1)));
}

static bool draw_path(struct light_case *out, struct rng *rng, const struct light_range *range)
{
	const struct cornea *c = &out->cornea;
	real r = rng_uniform(rng, 0, 1) < 0.02 ? 0 : c->rim * (1 - 1e-12) * sqrt(rng_uniform(rng, 0, 1));
	real angle = rng_uniform(rng, 0, 2 * M_PI), turn = rng_uniform(rng, 0, 2 * M_PI), N[3], side[3], up[3];
	if (rng_uniform(rng, 0, 1) < 0.02)
		r = c->rim * (1 - 1e-12);
	double x = r * cosl(angle), y = r * sinl(angle);
	real K[3] = { x, y, depth_at(c, (real)x * x + (real)y * y) };
	normal_at(N, c, K);
	real least[3] = { fabsl(N[0]) < 0.6L, fabsl(N[0]) >= 0.6L, 0 };
	for (int i = 0; i < 3; i++)
		side[i] = least[i] - dot(least, N) * N[i];
	real length = sqrtl(dot(side, side));
	for (int i = 0; i < 3; i++)
		side[i] /= length;
	for (int i = 0; i < 3; i++)
		up[i] = N[(i + 1) % 3] * side[(i + 2) % 3] - N[(i + 2) % 3] * side[(i + 1) % 3];
	real incidence = rng_uniform(rng, range->grazing_deg[0], range->grazing_deg[1]) * M_PI / 180;
	real s = sinl(incidence), ct = sqrtl(1 - s * s / ((real)c->n * c->n)), q[3], w[3];
	for (int i = 0; i < 3; i++) {
		real across = cosl(turn) * side[i] + sinl(turn) * up[i];
		w[i] = cosl(incidence) * N[i] + s * across;
		q[i] = -(ct * N[i] + s / c->n * across);
	}
	if (w[2] > -cos(range->behind_deg * M_PI / 180) || !(q[2] > 1e-3L))
		return false;
	real t = (rng_uniform(rng, range->depth[0], range->depth[1]) - K[2]) / q[2], away = powl(10, rng_uniform(rng, 0, 7));
	for (int i = 0; i < 3; i++) {
		out->P[i] = K[i] + t * q[i];
		out->K[i] = K[i];
		out->w[i] = w[i];
		out->C[i] = K[i] + away * w[i];
	}
	out->cos_i = cosl(incidence);
	const double *P = out->P;
	double inside = P[0] * P[0] + P[1] * P[1] + P[2] * (c->p * P[2] - 2 * c->R);
	return t > 0.05L && hypot(P[0], P[1]) <= range->radius && inside < -0.2 && c->p * P[2] < c->R;
}

void light_case_draw(struct light_case *out, struct rng *rng, const struct light_range *range)
{
	do
		draw_cornea(&out->cornea, rng, range->any_cornea);
	while (!draw_path(out, rng, range));
}

/* Sine of the angle between the refracted ray at K and the direction to P, in the plane y = 0; and cos i. */
static real miss(const struct cornea *c, const double P[3], const double C[3], const double w[3], real x, real *cos_i)
{
	real K[3] = { x, 0, depth_at(c, x * x) }, N[3], u[3], v[3], q[3];
	normal_at(N, c, K);
	for (int i = 0; i < 3; i++) {
		u[i] = C ? C[i] - K[i] : (real)w[i];
		v[i] = P[i] - K[i];
	}
	real lu = sqrtl(dot(u, u)), lv = sqrtl(dot(v, v));
	for (int i = 0; i < 3; i++)
		u[i] /= lu;
	*cos_i = dot(u, N);
	real ct = sqrtl(1 - (1 - *cos_i * *cos_i) / ((real)c->n * c->n));
	for (int i = 0; i < 3; i++)
		q[i] = -u[i] / c->n + (*cos_i / c->n - ct) * N[i];
	return (q[0] * v[2] - q[2] * v[0]) / lv;
}

int light_case_bracketed(double K[][3], int max, const struct cornea *cornea, const double P[3], const double C[3],
                         const double w[3])
{
	enum { SCAN = 4000 };
	int n = 0;
	real cos_i, edge = cornea->rim, low = -edge, f_low = miss(cornea, P, C, w, low, &cos_i);
	for (int i = 1; i <= SCAN; i++) {
		real high = -edge + 2 * edge * i / SCAN, f_high = miss(cornea, P, C, w, high, &cos_i), a = low, b = high;
		if ((f_low < 0) != (f_high < 0)) {
			for (int k = 0; k < 70; k++) {
				real mid = 0.5L * (a + b);
				*((miss(cornea, P, C, w, mid, &cos_i) < 0) == (f_low < 0) ? &a : &b) = mid;
			}
			miss(cornea, P, C, w, a, &cos_i);
			if (cos_i >= 0 && n < max) {
				K[n][0] = a;
				K[n][1] = 0;
				K[n++][2] = depth_at(cornea, a * a);
			}
		}
		low = high;
		f_low = f_high;
	}
	return n;
}

double light_case_snell(const struct cornea *c, const double P[3], const double C[3], const double w[3],
                        const double K[3])
{
	real k[3] = { K[0], K[1], depth_at(c, (real)K[0] * K[0] + (real)K[1] * K[1]) }, N[3], u[3], v[3], g[3];
	normal_at(N, c, k);
	for (int i = 0; i < 3; i++) {
		u[i] = C ? C[i] - k[i] : (real)w[i];
		v[i] = k[i] - P[i];
	}
	real lu = sqrtl(dot(u, u)), lv = sqrtl(dot(v, v));
	for (int i = 0; i < 3; i++)
		g[i] = c->n * v[i] / lv - u[i] / lu;
	real across = dot(g, N), sum = 0;
	for (int i = 0; i < 3; i++)
		sum += (g[i] - across * N[i]) * (g[i] - across * N[i]);
	return sqrtl(sum);
}
