#include "tests/lib/truth/light_case.h"

#include <math.h>

typedef long double real;

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
	c->R = rng_range(rng, 5, 12);
	c->p = rng_range(rng, 0, 1) < 0.05 ? 0 : rng_range(rng, 0, 2);
	double kind = rng_range(rng, 0, 1);
	c->n = kind < 0.05 ? 1 : kind < 0.15 ? 1 + pow(10, rng_range(rng, -12, -1)) : rng_range(rng, 1.01, 2);
	c->rim = fmin(rng_range(rng, 4, 8), 0.98 * c->R / sqrt(fmax(c->p, 0.1)));
}

/* Direction inside at the surface point over (x, y), for light from direction w, or from the point C. */
static void inside_at(real q[3], real K[3], const struct cornea *c, real x, real y, const real direction[3], const double *C)
{
	real N[3], w[3] = { direction[0], direction[1], direction[2] };
	K[0] = x;
	K[1] = y;
	K[2] = depth_at(c, x * x + y * y);
	normal_at(N, c, K);
	if (C) {
		for (int i = 0; i < 3; i++)
			w[i] = C[i] - K[i];
		real length = sqrtl(dot(w, w));
		for (int i = 0; i < 3; i++)
			w[i] /= length;
	}
	real ci = dot(w, N), ct = sqrtl(1 - (1 - ci * ci) / ((real)c->n * c->n));
	for (int i = 0; i < 3; i++)
		q[i] = -w[i] / c->n + (ci / c->n - ct) * N[i];
}

/* 1 / smallest stretch of the map from (x, y) of K to the place across the ray at distance t behind, by differences. */
static double spread_at(const struct cornea *c, const real K[3], const real w[3], const double *C, real t)
{
	real q[3], k0[3], d[2][3], h = 1e-7L;
	inside_at(q, k0, c, K[0], K[1], w, C);
	for (int j = 0; j < 2; j++) {
		real qj[3], kj[3], along = 0;
		inside_at(qj, kj, c, K[0] + (j == 0) * h, K[1] + (j == 1) * h, w, C);
		for (int i = 0; i < 3; i++) {
			d[j][i] = (kj[i] + t * qj[i] - k0[i] - t * q[i]) / h;
			along += d[j][i] * q[i];
		}
		for (int i = 0; i < 3; i++)
			d[j][i] -= along * q[i];
	}
	real a = dot(d[0], d[0]), b = dot(d[0], d[1]), e = dot(d[1], d[1]);
	real least = 0.5L * (a + e) - sqrtl(0.25L * (a - e) * (a - e) + b * b);
	return 1 / sqrtl(fmaxl(least, 1e-30L));
}

static bool draw_path(struct light_case *out, struct rng *rng, const struct light_range *range)
{
	const struct cornea *c = &out->cornea;
	real r = rng_range(rng, 0, 1) < 0.02 ? 0 : c->rim * (1 - 1e-12) * sqrt(rng_range(rng, 0, 1));
	real angle = rng_range(rng, 0, 2 * M_PI), turn = rng_range(rng, 0, 2 * M_PI), N[3], side[3], up[3];
	if (rng_range(rng, 0, 1) < 0.02)
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
	real incidence = rng_range(rng, range->grazing_deg[0], range->grazing_deg[1]) * M_PI / 180;
	real s = sinl(incidence), ct = sqrtl(1 - s * s / ((real)c->n * c->n)), q[3], w[3];
	for (int i = 0; i < 3; i++) {
		real across = cosl(turn) * side[i] + sinl(turn) * up[i];
		w[i] = cosl(incidence) * N[i] + s * across;
		q[i] = -(ct * N[i] + s / c->n * across);
	}
	if (w[2] > -cos(range->behind_deg * M_PI / 180) || !(q[2] > 1e-3L))
		return false;
	real t = (rng_range(rng, range->depth[0], range->depth[1]) - K[2]) / q[2], away = powl(10, rng_range(rng, 0, 7));
	for (int i = 0; i < 3; i++) {
		out->P[i] = K[i] + t * q[i];
		out->K[i] = K[i];
		out->w[i] = w[i];
		out->C[i] = K[i] + away * w[i];
	}
	out->cos_i = cosl(incidence);
	out->spread[0] = spread_at(c, K, w, 0, t);
	out->spread[1] = spread_at(c, K, w, out->C, t);
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

enum light_verdict light_case_judge(const struct light_case *c, bool point, const double K[3], double tolerance)
{
	double gap = hypot(hypot(K[0] - c->K[0], K[1] - c->K[1]), K[2] - c->K[2]);
	if (gap <= tolerance)
		return LIGHT_RIGHT;
	const double *C = point ? c->C : 0;
	real k[3] = { K[0], K[1], depth_at(&c->cornea, (real)K[0] * K[0] + (real)K[1] * K[1]) }, N[3], u[3];
	normal_at(N, &c->cornea, k);
	for (int i = 0; i < 3; i++)
		u[i] = C ? C[i] - k[i] : (real)c->w[i];
	double snell = light_case_snell(&c->cornea, c->P, C, c->w, K);
	bool physical = dot(u, N) >= 0 && hypot(K[0], K[1]) <= c->cornea.rim && fabsl(k[2] - K[2]) < 1e-13L && snell <= 1e-12;
	// Close by, it is no other path but a bad one; except at a focus, where two paths meet, and each keeps the law to
	// the last digit that K has.
	return physical && (gap > 1e3 * tolerance || snell <= 1e-15) ? LIGHT_OTHER_PATH : LIGHT_WRONG;
}
