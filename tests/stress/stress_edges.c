/* The light path where it is hardest, against 128 bits: grazing light, the rim, deep points, the axis, cameras at 1 mm and at
 * 10 km, the sphere's and the parabola's limits, indices next to 1 and below it, total reflection; solved one by one in double
 * and in batches in float. What is solved is the rounded problem itself, so that an error is the solver's own: it may be as
 * large as rounding in the sines of Snell's law makes it. Flagged: refused with its reason, or another path of the problem. */
#include <float.h>
#include <stdio.h>
#include <stdlib.h>

#include "base/mem.h"
#include "optics/lightpath/lightpath.h"
#include "tests/lib/truth/quad.h"
#include "tests/lib/stress.h"
#include "tests/peers/fresnel.h"

struct range {
	double incidence[2];  // degrees
	double r[2];          // of K, in rims
	double depth[2];      // mm
	double away[2];       // log10 of mm to the light
	double p[2], n[2];
	bool log_p, log_n;    // p and n - 1 by their logarithms
};
static const struct range plain = { .incidence = { 0, 85 }, .r = { 0, 0.99 }, .depth = { 2.5, 3.3 }, .away = { 0, 7 }, .p = { 0.75, 0.75 }, .n = { 1.336, 1.336 } };

struct path_case {
	struct cornea c;
	double P[3], C[3], w[3], K[3];  // K: next to the crossing, at the most
};

static double drawn(struct rng *rng, const double range[2], bool log)
{
	double x = rng_range(rng, range[0], range[1]);
	return log ? pow(10, x) : x;
}

/* Forwards: a point of the surface, light from a direction, the refracted ray to some depth. False where that is no case. */
static bool make(struct path_case *t, struct rng *rng, const struct range *range)
{
	t->c = (struct cornea){ .R = 7.8, .p = drawn(rng, range->p, range->log_p), .n = range->log_n ? 1 + drawn(rng, range->n, true) : drawn(rng, range->n, false), .rim = 5.85 };
	double r = t->c.rim * drawn(rng, range->r, false), at = rng_range(rng, 0, 2 * M_PI), turn = rng_range(rng, 0, 2 * M_PI);
	double i = drawn(rng, range->incidence, false) * M_PI / 180, away = drawn(rng, range->away, true);
	quad K[3], N[3], u[3], q[3], side[3];
	quad_surface(K, N, &t->c, r * cos(at), r * sin(at));
	double normal[3] = { (double)N[0], (double)N[1], (double)N[2] }, any[3] = { cos(turn), sin(turn), 0 };
	double along = any[0] * normal[0] + any[1] * normal[1], length = 0;
	for (int k = 0; k < 3; k++)
		length = hypot(length, (double)(side[k] = any[k] - along * normal[k]));
	if (!(length > 0.01))
		return false;
	for (int k = 0; k < 3; k++) {
		u[k] = cos(i) * N[k] + sin(i) * side[k] / length;
		t->w[k] = (double)u[k];
		t->C[k] = (double)(K[k] + away * u[k]);
		t->K[k] = (double)K[k];
	}
	if (!quad_refract(q, u, N, t->c.n) || !((double)q[2] > 0.05) || !((double)u[2] < 0))
		return false;
	quad run = (rng_range(rng, range->depth[0], range->depth[1]) - K[2]) / q[2];
	for (int k = 0; k < 3; k++)
		t->P[k] = (double)(K[k] + run * q[k]);
	double inside = t->P[0] * t->P[0] + t->P[1] * t->P[1] + t->P[2] * (t->c.p * t->P[2] - 2 * t->c.R);
	return (double)run > 0.05 && inside < -0.1 && t->c.p * t->P[2] < t->c.R && hypot(t->C[0], t->C[1]) + fabs(t->C[2]) > 0;
}

static double gap(const double a[3], const quad b[3])
{
	return hypot(hypot((double)(a[0] - b[0]), (double)(a[1] - b[1])), (double)(a[2] - b[2]));
}

static void in_double(struct stress *s, const struct path_case *t, const double *C)
{
	double K[3], stretch;
	quad want[3];
	if (!quad_path(want, &stretch, &t->c, t->P, C, t->w, t->K[0], t->K[1])) {
		stress_flagged(s);  // a focus: no place is the crossing
		return;
	}
	enum lightpath_status status = C ? lightpath_solve(K, &t->c, t->P, C) : lightpath_solve_directional(K, &t->c, t->P, t->w);
	double off = gap(K, want), law = quad_snell(&t->c, t->P, C, t->w, K[0], K[1]);
	double most = 1e-14 + 32 * DBL_EPSILON * stretch;
	if (!isfinite(K[0] + K[1] + K[2]))
		stress_wrong(s, "K is no number, status %d", status);
	else if (status != LIGHTPATH_OK)  // rounding may have put K beyond the rim, or its light behind the surface
		stress_flagged(s);
	else if (off > most && law < 1e-12 && off > 1e3 * most)
		stress_flagged(s);  // another path
	else {
		stress_lost(s, off / t->c.R);
		if (off > most)
			stress_wrong(s, "K off by %.2g mm, %.2g expected of rounding; Snell's law by %.2g", off, most, law);
	}
}

static void in_float(struct stress *s, struct path_case t)
{
	float P[3], w[3], k[3];
	unsigned char status;
	double K[3], stretch;
	quad want[3];
	for (int i = 0; i < 3; i++) {
		volatile float p = (float)t.P[i], d = (float)t.w[i];
		t.P[i] = (double)(P[i] = p);
		t.w[i] = (double)(w[i] = d);
	}
	if (!quad_path(want, &stretch, &t.c, t.P, 0, t.w, t.K[0], t.K[1])) {
		stress_flagged(s);
		return;
	}
	lightpath_batch(1, P, P + 1, P + 2, w, w + 1, w + 2, k, k + 1, k + 2, &status, &t.c, 4);
	for (int i = 0; i < 3; i++)
		K[i] = (double)k[i];
	double off = gap(K, want), law = quad_snell(&t.c, t.P, 0, t.w, K[0], K[1]), most = 2e-5 + 32 * (double)FLT_EPSILON * stretch;
	if (!isfinite(K[0] + K[1] + K[2]))
		stress_wrong(s, "float: K is no number, status %d", status);
	else if (status != LIGHTPATH_OK || (off > most && law < 1e-5))
		stress_flagged(s);
	else {
		stress_lost_of(s, off / t.c.R, (double)FLT_EPSILON);
		if (off > most)
			stress_wrong(s, "float: K off by %.2g mm, %.2g expected of rounding; Snell's law by %.2g", off, most, law);
	}
}

static void one(struct stress *s, const struct range *range, bool single)
{
	struct path_case t;
	while (!make(&t, &s->rng, range))
		;
	stress_about(s, "p %.17g n %.17g P %.17g %.17g %.17g w %.17g %.17g %.17g C %.17g %.17g %.17g", t.c.p, t.c.n, t.P[0], t.P[1], t.P[2], t.w[0], t.w[1],
	             t.w[2], t.C[0], t.C[1], t.C[2]);
	if (single)
		in_float(s, t);
	else
		in_double(s, &t, s->index % 2 ? t.C : 0);
}

/* Out of the eye: totally reflected where the 128-bit solution is, with no transmission; else refracted as that solution. */
static void leaving(struct stress *s)
{
	double n1 = rng_range(&s->rng, 1, 2), n2 = rng_range(&s->rng, 0.5, n1), critical = asin(n2 / n1);
	double off = rng_below(&s->rng, 2) ? pow(10, rng_range(&s->rng, -17, -1)) * (rng_below(&s->rng, 2) ? 1 : -1) : 0;
	double t = off != 0 ? fmin(fmax(critical + off, 0), M_PI / 2) : rng_range(&s->rng, 0, M_PI / 2), out[3];
	const double N[3] = { 0, 0, -1 }, dir[3] = { sin(t), 0, cos(t) };
	const quad w[3] = { -dir[0], 0, -dir[2] }, normal[3] = { 0, 0, -1 };
	quad q[3];
	stress_about(s, "from index %.17g into %.17g at %.17g of the critical angle", n1, n2, t / critical);
	bool passes = refract(out, dir, N, n1, n2), want = quad_refract(q, w, normal, (quad)n2 / n1);
	double through = fresnel_transmittance(dir[2], n1, n2), sine = n1 / n2 * sin(t);
	if (!(through >= 0 && through <= 1))
		stress_wrong(s, "lets through %g", through);
	else if (passes != want) {
		if (fabs(sine - 1) > 8 * DBL_EPSILON)
			stress_wrong(s, "%s, at a sine of 1 %+.2g", passes ? "bent" : "reflected", sine - 1);
		else
			stress_flagged(s);  // on the last digit
	} else if (passes) {
		// The cosine is a root of what is left of 1: half of its digits.
		double wrong = hypot((double)(out[0] - q[0]), (double)(out[2] - q[2])), most = 16 * DBL_EPSILON / fmax(fabs((double)q[2]), 1e-8);
		stress_lost(s, wrong);
		if (!(wrong <= most))
			stress_wrong(s, "direction off by %.2g, %.2g expected of rounding", wrong, most);
	} else if (through > 0)
		stress_wrong(s, "reflects totally and lets through %g", through);
}

/* The solver given an index below 1, or light from behind: whatever it calls a path keeps Snell's law on the lit side. */
static void none(struct stress *s)
{
	struct path_case t;
	while (!make(&t, &s->rng, &plain))
		;
	double length = 0, K[3];
	bool behind = rng_below(&s->rng, 2);
	t.c.n = behind ? t.c.n : rng_range(&s->rng, 0.3, 1);
	for (int k = 0; k < 3; k++)
		length = hypot(length, t.w[k] = rng_normal(&s->rng) + (behind && k == 2 ? 2 : 0));
	for (int k = 0; k < 3; k++) {
		t.w[k] /= length;
		t.C[k] = 1e3 * t.w[k];
	}
	stress_about(s, "n %.17g P %.17g %.17g %.17g w %.17g %.17g %.17g", t.c.n, t.P[0], t.P[1], t.P[2], t.w[0], t.w[1], t.w[2]);
	const double *C = s->index % 2 ? t.C : 0;
	enum lightpath_status status = C ? lightpath_solve(K, &t.c, t.P, C) : lightpath_solve_directional(K, &t.c, t.P, t.w);
	if (!isfinite(K[0] + K[1] + K[2]))
		stress_wrong(s, "K is no number, status %d", status);
	else if (status != LIGHTPATH_OK)
		stress_flagged(s);
	else {
		double law = quad_snell(&t.c, t.P, C, t.w, K[0], K[1]), lit = 0, N[3];
		cornea_normal(N, &t.c, K);
		for (int k = 0; k < 3; k++)
			lit += N[k] * (C ? (C[k] - K[k]) / 1e3 : t.w[k]);
		stress_lost(s, law);
		if (law > 1e-12 || lit < -1e-9 || hypot(K[0], K[1]) > t.c.rim + 1e-9)
			stress_wrong(s, "a path that breaks Snell's law by %.2g, cos i %.2g", law, lit);
	}
}

int main(int argc, char **argv)
{
	struct stress s;
	struct range r[9];
	static const char *const names[] = { "incidence of 0 to 89.99 degrees", "incidence of 89 to 89.99 degrees", "at the limbus' rim", "behind the iris",
		"on the axis", "camera at 1 mm, camera at 10 km", "p towards 0", "p from 1 to 2", "n towards 1" };
	for (int i = 0; i < COUNT(r); i++)
		r[i] = plain;
	r[0].incidence[1] = r[1].incidence[1] = 89.99;
	r[1].incidence[0] = 89;
	r[2].r[0] = 1 - 1e-9;
	r[2].r[1] = 1;
	r[3].depth[0] = 3.3;
	r[3].depth[1] = 9;
	r[4].r[1] = 1e-12;
	r[4].incidence[1] = 1e-6;
	r[5].away[0] = 0;
	r[5].away[1] = 0.01;
	r[6].p[0] = -30;
	r[6].p[1] = -1;
	r[6].log_p = true;
	r[7].p[0] = 1;
	r[7].p[1] = 1.7;
	r[8].n[0] = -17;
	r[8].n[1] = -1;
	r[8].log_n = true;
	stress_start(&s, "edges", argc, argv);
	for (int single = 0; single < 2; single++)
		for (int i = 0; i < COUNT(r); i++) {
			char *name = mem_printf("%s, %s", names[i], single ? "float" : "double");
			for (stress_family(&s, name, 20000); stress_case(&s);) {
				if (i == 5)  // one or the other
					r[5].away[0] = (r[5].away[1] = s.index % 4 < 2 ? 0.01 : 7) - 0.01;
				one(&s, &r[i], single);
			}
			free(name);
		}
	for (stress_family(&s, "out of the eye, total reflection", 1000000); stress_case(&s);)
		leaving(&s);
	for (stress_family(&s, "an index below 1, light from behind", 20000); stress_case(&s);)
		none(&s);
	return stress_end(&s);
}
