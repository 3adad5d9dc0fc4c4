/* Ellipse fits from circles to slivers, from all round to five degrees, five points, lines, far from the origin, among
 * outliers: against the Cramér-Rao bound. Without noise the rounding of the points themselves is the noise: no fit can
 * know them better. Flagged: refused, or reported with a standard deviation that covers the error. */
#include <float.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "math/ellipse_fit.h"
#include "tests/lib/stress.h"
#include "tests/peers/ellipse_bound.h"

enum { N = ELLIPSE_N, MOST = 400, DRAWS = 200 };

struct scene {
	struct ellipse e;
	int n;
	double from, arc, sigma, outliers;
	double p[MOST][2], t[MOST];
};

/* b/a: 1 - 1e-12 .. 0.05, round ones as often as flat ones. */
static double draw_ratio(struct rng *rng)
{
	return rng_uniform(rng) < 0.5 ? 1 - pow(10, rng_range(rng, -12, -1)) : rng_range(rng, 0.05, 0.9);
}

static struct ellipse draw_ellipse(struct rng *rng, double offset)
{
	double a = pow(10, rng_range(rng, 1, 3));
	return (struct ellipse){ offset * rng_range(rng, -1, 1), offset * rng_range(rng, -1, 1), a, a * draw_ratio(rng),
		rng_range(rng, 0, M_PI) };
}

static void draw_points(struct scene *s, struct rng *rng)
{
	for (int i = 0; i < s->n; i++) {
		double normal[2], d;
		s->t[i] = s->from + s->arc * (i + 0.5) / s->n;
		ellipse_point(s->p[i], normal, &s->e, s->t[i]);
		d = rng_uniform(rng) < s->outliers ? rng_range(rng, -0.3, 0.3) * s->e.b : s->sigma * rng_normal(rng);
		s->p[i][0] += d * normal[0];
		s->p[i][1] += d * normal[1];
	}
}

/* d' C^-1 d / 5 of the errors d of q, in two covariances: the Cramér-Rao bound's and the fit's own. */
static double squared(const struct ellipse *got, const struct ellipse *want, double C[N][N])
{
	double L[N][N] = { 0 }, x[N], y[N], d[N], sum = 0, scale[N];
	ellipse_to_q(x, got);
	ellipse_to_q(y, want);
	for (int i = 0; i < N; i++) {
		scale[i] = sqrt(C[i][i]);
		d[i] = (x[i] - y[i]) / scale[i];
	}
	for (int j = 0; j < N; j++)
		for (int i = j; i < N; i++) {
			double v = C[i][j] / (scale[i] * scale[j]);
			for (int k = 0; k < j; k++)
				v -= L[i][k] * L[j][k];
			L[i][j] = i == j ? sqrt(fmax(v, 1e-13)) : v / L[j][j];
		}
	for (int i = 0; i < N; i++) {
		for (int k = 0; k < i; k++)
			d[i] -= L[i][k] * d[k];
		d[i] /= L[i][i];
		sum += d[i] * d[i] / N;
	}
	return sum;
}

static bool is_ellipse(const struct ellipse *e)
{
	return isfinite(e->cx + e->cy + e->a + e->b + e->angle) && e->b > 0 && e->a >= e->b;
}

static double error_of(const struct ellipse *got, const struct ellipse *want)
{
	double x[N], y[N], worst = 0;
	ellipse_to_q(x, got);
	ellipse_to_q(y, want);
	for (int i = 0; i < N; i++)
		worst = fmax(worst, fabs(x[i] - y[i]));
	return worst / want->a;
}

/* Points without noise, both fits: as good as the rounding of the points allows. */
static void exact(struct stress *s, struct scene *c, double margin)
{
	struct ellipse direct, robust;
	struct ellipse_fit fit;
	double C[N][N], worst = 0;
	draw_points(c, &s->rng);
	/* Each point is rounded to its coordinates' size, and so is every step of the sums. */
	double digit = DBL_EPSILON * (c->e.a + fabs(c->e.cx) + fabs(c->e.cy));
	stress_about(s, "a %.4g, 1 - b/a %.3g, centre %.6g %.6g, arc %.1f deg, %d points", c->e.a, 1 - c->e.b / c->e.a, c->e.cx,
	             c->e.cy, c->arc * 180 / M_PI, c->n);
	bool known = ellipse_bound(C, &c->e, c->n, c->t, digit);
	for (int i = 0; i < N && known; i++)
		worst = fmax(worst, sqrt(C[i][i]) / c->e.a);
	worst = fmax(worst, DBL_EPSILON);
	if (!known || worst * margin > 0.01)
		stress_flagged(s);
	bool ok = ellipse_fit_direct(&direct, c->n, c->p, 0);
	if (!ok || !is_ellipse(&direct)) {
		if (ok)
			stress_wrong(s, "direct fit: not an ellipse");
		stress_flagged(s);
	} else {
		stress_lost(s, error_of(&direct, &c->e));
		/* It solves normal equations: what the bound magnifies, it magnifies twice; and a sliver's conic has
		 * coefficients (a/b)^2 apart, squared again. */
		double twice = margin * worst * fmax(worst / DBL_EPSILON, pow(c->e.a / c->e.b, 4));
		if (!s->case_flagged && error_of(&direct, &c->e) > twice)
			stress_wrong(s, "direct fit off by %.2g of a; rounding explains %.2g", error_of(&direct, &c->e), twice);
	}
	if (c->n < 12)
		return;
	if (!ellipse_fit_robust(&robust, &fit, c->n, c->p, 0, 0, 1e-3 * c->e.b, false)) {
		stress_flagged(s);
	} else if (!is_ellipse(&robust)) {
		stress_wrong(s, "robust fit: not an ellipse");
	} else if (!s->case_flagged) {
		stress_lost(s, error_of(&robust, &c->e));
		if (error_of(&robust, &c->e) > margin * worst)
			stress_wrong(s, "robust fit off by %.2g of a; rounding explains %.2g", error_of(&robust, &c->e), worst);
	}
}

/* Many draws of the same scene: rms error against the bound of the points that are no outliers. */
static void noisy(struct stress *s, struct scene *c, bool scale_known)
{
	double C[N][N], sum = 0, own = 0, large = 0;
	int n = 0, refused = 0;
	draw_points(c, &s->rng);
	if (!ellipse_bound(C, &c->e, c->n, c->t, c->sigma))
		memset(C, 0, sizeof C);
	for (int i = 0; i < N; i++)
		for (int j = 0; j < N; j++)
			C[i][j] /= 1 - c->outliers;
	for (int i = 0; i < N; i++)
		large = fmax(large, sqrt(C[i][i]) / c->e.b);
	stress_about(s, "a %.4g, 1 - b/a %.3g, centre %.6g %.6g, arc %.1f deg, %d points, sigma %.3g, outliers %.0f %%, bound %.2g of b",
	             c->e.a, 1 - c->e.b / c->e.a, c->e.cx, c->e.cy, c->arc * 180 / M_PI, c->n, c->sigma, 100 * c->outliers, large);
	for (int i = 0; i < DRAWS; i++) {
		struct ellipse e;
		struct ellipse_fit fit;
		draw_points(c, &s->rng);
		if (!ellipse_fit_robust(&e, &fit, c->n, c->p, 0, 0, scale_known ? c->sigma : 0, false)) {
			refused++;
			continue;
		}
		double bound = squared(&e, &c->e, C), said = squared(&e, &c->e, fit.cov_q);
		if (!is_ellipse(&e) || !isfinite(said)) {
			stress_wrong(s, "draw %d: not an ellipse, or no covariance", i);
			return;
		}
		n++;
		sum += bound;
		own += said;
	}
	if (refused || large > 0.03 || !(large > 0))
		stress_flagged(s);
	if (!n || !(large > 0))
		return;
	double ratio = sqrt(sum / n), trust = sqrt(own / n);
	if (s->show)
		printf("  %d draws, %d refused: rms error / bound %.3f, / own sigma %.3f\n", DRAWS, refused, ratio, trust);
	if (s->case_flagged)
		return;
	stress_measure(s, ratio, "times the bound");
	/* 5 DRAWS numbers: the ratio's own standard deviation is 0.022. */
	if (ratio < 0.89)
		stress_wrong(s, "better than the bound: %.3f of it", ratio);
	if (ratio > 1.5 && trust > 1.5)
		stress_wrong(s, "%.3g times the bound, %.3g times its own sigma", ratio, trust);
}

static void lines(struct stress *s)
{
	struct scene c = { .n = 5 + rng_below(&s->rng, 60) };
	struct ellipse e;
	struct ellipse_fit fit;
	double angle = rng_range(&s->rng, 0, M_PI), off = rng_uniform(&s->rng) < 0.3 ? 0 : pow(10, rng_range(&s->rng, -14, -1));
	double x = rng_range(&s->rng, -1e3, 1e3), y = rng_range(&s->rng, -1e3, 1e3);
	for (int i = 0; i < c.n; i++) {
		double d = rng_range(&s->rng, -100, 100), across = off * rng_normal(&s->rng);
		c.p[i][0] = x + d * cos(angle) - across * sin(angle);
		c.p[i][1] = y + d * sin(angle) + across * cos(angle);
	}
	stress_about(s, "%d points on a line at %.1f deg, %.2g px off it", c.n, angle * 180 / M_PI, off);
	bool direct = ellipse_fit_direct(&e, c.n, c.p, 0);
	if (direct && !is_ellipse(&e))
		stress_wrong(s, "direct fit: not an ellipse");
	if (!ellipse_fit_robust(&e, &fit, c.n, c.p, 0, 0, 0, false)) {
		stress_flagged(s);
		return;
	}
	double sigma[N];
	ellipse_sigma(sigma, &e, fit.cov_q);
	stress_measure(s, e.b / e.a, "b/a seen in a line");
	if (!is_ellipse(&e) || !isfinite(sigma[0] + sigma[3]))
		stress_wrong(s, "robust fit: not an ellipse");
	else if (e.b > 0.3 * e.a && sigma[3] < 0.1 * e.b)
		stress_wrong(s, "a line taken for an ellipse of b/a %.2g, b sure to %.1g", e.b / e.a, sigma[3] / e.b);
}

/* Anything at all: an answer that is finite, or none. */
static void garbage(struct stress *s)
{
	static const double strange[] = { NAN, INFINITY, -INFINITY, 0, -0.0, 1e300, -1e300, 1e-300, 5e-324, 1e7 };
	struct scene c = { .n = rng_below(&s->rng, 40) };
	struct ellipse e;
	struct ellipse_fit fit;
	const int kind = rng_below(&s->rng, 4);
	double size = pow(10, rng_range(&s->rng, -150, 150));
	for (int i = 0; i < c.n; i++)
		for (int k = 0; k < 2; k++)
			c.p[i][k] = kind == 0   ? strange[rng_below(&s->rng, COUNT(strange))]
			            : kind == 1 ? size * rng_normal(&s->rng)
			            : kind == 2 ? rng_below(&s->rng, 3)
			            : i && rng_uniform(&s->rng) < 0.8 ? c.p[0][k]
			                                              : rng_normal(&s->rng);
	stress_about(s, "%d points of kind %d, size %.1g", c.n, kind, kind == 1 ? size : 1);
	bool direct = ellipse_fit_direct(&e, c.n, c.p, 0);
	if (direct && !is_ellipse(&e))
		stress_wrong(s, "direct fit: not an ellipse");
	bool robust = ellipse_fit_robust(&e, &fit, c.n, c.p, 0, 0, 0, false);
	if (robust && (!is_ellipse(&e) || !isfinite(fit.sigma + fit.cov_q[0][0] + fit.cov_q[3][3])))
		stress_wrong(s, "robust fit: not an ellipse, or no covariance");
	if (!direct && !robust)
		stress_flagged(s);
}

int main(int argc, char **argv)
{
	struct stress s;
	struct scene *c = mem_new(1, sizeof *c);
	const double round = 2 * M_PI;
	stress_start(&s, "ellipse", argc, argv);
	for (stress_family(&s, "exact points, circle to sliver", 2000); stress_case(&s);) {
		*c = (struct scene){ draw_ellipse(&s.rng, 1e3), .n = 12 + rng_below(&s.rng, 300), .arc = round };
		exact(&s, c, 100);
	}
	for (stress_family(&s, "exact points, offset by up to 1e7", 2000); stress_case(&s);) {
		*c = (struct scene){ draw_ellipse(&s.rng, pow(10, rng_range(&s.rng, 0, 7))), .n = 12 + rng_below(&s.rng, 300), .arc = round };
		exact(&s, c, 100);
	}
	for (stress_family(&s, "exact points, arcs of 5 to 360 degrees", 2000); stress_case(&s);) {
		*c = (struct scene){ draw_ellipse(&s.rng, 1e3), .n = 20 + rng_below(&s.rng, 300), .from = rng_range(&s.rng, 0, round) };
		c->arc = round * pow(72, -rng_uniform(&s.rng));
		exact(&s, c, 1000);
	}
	for (stress_family(&s, "exact points, five of them", 10000); stress_case(&s);) {
		*c = (struct scene){ draw_ellipse(&s.rng, 1e3), .n = 5, .arc = round * rng_range(&s.rng, 0.1, 1) };
		exact(&s, c, 1000);
	}
	for (stress_family(&s, "points on a line", 2000); stress_case(&s);)
		lines(&s);
	for (stress_family(&s, "points of any kind", 10000); stress_case(&s);)
		garbage(&s);
	for (stress_family(&s, "noise, all round", 40); stress_case(&s);) {
		*c = (struct scene){ draw_ellipse(&s.rng, 1e3), .n = 30 + rng_below(&s.rng, 150), .arc = round };
		c->sigma = c->e.b * pow(10, rng_range(&s.rng, -5, -2));
		noisy(&s, c, s.index % 2);
	}
	for (stress_family(&s, "noise, arcs of 5 to 360 degrees", 40); stress_case(&s);) {
		*c = (struct scene){ draw_ellipse(&s.rng, 1e3), .n = 60 + rng_below(&s.rng, 150), .from = rng_range(&s.rng, 0, round) };
		c->arc = round * pow(72, -rng_uniform(&s.rng));
		c->sigma = c->e.b * pow(10, rng_range(&s.rng, -7, -2));
		noisy(&s, c, s.index % 2);
	}
	for (stress_family(&s, "outliers, up to half", 40); stress_case(&s);) {
		*c = (struct scene){ draw_ellipse(&s.rng, 1e7), .n = 150 + rng_below(&s.rng, 100), .arc = round * rng_range(&s.rng, 0.6, 1) };
		c->e.b = fmax(c->e.b, 0.3 * c->e.a);
		c->sigma = c->e.b * pow(10, rng_range(&s.rng, -4, -2.3));
		c->outliers = rng_range(&s.rng, 0, 0.5);
		noisy(&s, c, s.index % 2);
	}
	free(c);
	return stress_end(&s);
}
