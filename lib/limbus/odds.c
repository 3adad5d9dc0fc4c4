#include "limbus/odds.h"

#include <math.h>

#include "math/stats.h"

enum { RINGS = 6, STEP = 6, APART = 8 };
static const double EVEN = 0.003;       // of a step: flat but for rounding
static const double BESIDE = 0.09;      // semi-axes: how far from the edge the evidence is read
static const double FLOOR = 1e-3;       // scatter and sigma count no lower
static const double UNIT = 400;         // pixels in an iris of the evidence's usual size, about

/* Mean chance of a class along the edge, s px outward; over the arcs in use, or all. 0 over none. */
static double beside(const struct evidence *e, enum evidence_class class, const struct rim *rim, double s, const bool *use)
{
	double sum = 0;
	int n = 0;
	for (int i = 0; i < ARCS; i += use ? 1 : STEP)
		if (!use || use[i]) {
			double p[2], normal[2];
			ellipse_point(p, normal, &rim->e, rim->t[i]);
			sum += evidence_at(e, class, p[0] + s * normal[0], p[1] + s * normal[1]);
			n++;
		}
	return n ? sum / n : 0;
}

/* Mean chance of a class between two copies of the ellipse, `from` and `to` times as large. */
static double between(const struct evidence *e, enum evidence_class class, const struct ellipse *at, double from, double to)
{
	double sum = 0, weight = 0;
	for (int j = 0; j < RINGS; j++) {
		struct ellipse f = *at;
		const double k = from + (to - from) * (j + 0.5) / RINGS;
		f.a *= k;
		f.b *= k;
		for (int i = 0; i < ARCS; i += STEP) {
			double p[2], normal[2];
			ellipse_point(p, normal, &f, 2 * M_PI * i / ARCS);
			sum += k * evidence_at(e, class, p[0], p[1]);
			weight += k;
		}
	}
	return sum / weight;
}

static double beyond(const struct ellipse *e, int width, int height)
{
	int n = 0;
	for (int i = 0; i < ARCS; i++) {
		double p[2], normal[2];
		ellipse_point(p, normal, e, 2 * M_PI * i / ARCS);
		n += p[0] < 0 || p[1] < 0 || p[0] > width || p[1] > height;
	}
	return (double)n / ARCS;
}

/* Logarithm of the spread of the brightness on one side of the step along the ring, neighbours against each other, in steps. */
static double varies(const struct rim *rim, bool outside)
{
	double d[ARCS], jump[ARCS];
	int n = 0;
	for (int i = 0; i < ARCS; i++) {
		const int k = (i + APART) % ARCS;
		if (!rim->used[i] || !rim->used[k])
			continue;
		const struct step *p = &rim->step[i], *q = &rim->step[k];
		d[n] = outside ? p->out - q->out : p->in - q->in;
		jump[n++] = p->out - p->in;
	}
	return n ? log(stats_mad(n, d, 0) / stats_median(n, jump) + EVEN) : log(EVEN);
}

double odds_sigma(const struct rim *rim)
{
	double sigma[ELLIPSE_N], worst = 0;
	ellipse_sigma(sigma, &rim->e, rim->cov_q);
	for (int i = 0; i < 4; i++)
		worst = fmax(worst, sigma[i]);
	return worst / rim->e.a;
}

/* Logarithm of a distance in semi-axes, at most half of one. */
static double log_share(double distance)
{
	return log(fmin(distance, 0.5) + FLOOR);
}

/* What the strip says of the ellipse. */
static void of_strip(double x[ODDS_TRAITS], const struct ellipse *e, const struct odds_view *view)
{
	const struct strip_accord a = strip_accord_of(view->strip, e);
	struct ellipse told = view->strip->e;
	double q[ELLIPSE_N], off = 0, sigma = 0;
	ellipse_from_q(&told, view->told->q);
	ellipse_to_q(q, e);
	for (int i = 0; i < ELLIPSE_N; i++) {
		off = fmax(off, fabs(q[i] - view->told->q[i]));
		sigma = fmax(sigma, view->told->sigma[i]);
	}
	const bool any = view->told->q[2] > 0;
	x[ODDS_STRIP_SEEN] = a.seen;
	x[ODDS_STRIP_ON] = a.on;
	x[ODDS_STRIP_OFF] = a.off;
	x[ODDS_STRIP_WORTH] = a.worth;
	x[ODDS_STRIP_BEHIND] = any ? fmin(fmax(strip_worth(view->strip, &told) - a.worth, 0), 20) : 20;
	x[ODDS_STRIP_SCATTER] = log(a.scatter + FLOOR);
	x[ODDS_STRIP_APART] = any ? log_share(off / e->a) : log(0.5);
	x[ODDS_STRIP_SIGMA] = any ? log_share(sigma / e->a) : log(0.5);
	x[ODDS_STRIP_MOVED] = any ? log_share(view->moved / e->a) : log(0.5);
	x[ODDS_STRIP_BLIND] = any ? log_share(view->blind / e->a) : log(0.5);
	x[ODDS_STRIP_END] = a.end;
}

void odds_traits(double x[ODDS_TRAITS], const struct rim *rim, const struct rim *pupil, const struct odds_view *view)
{
	const struct ellipse *e = &rim->e;
	const struct evidence *evidence = view->evidence;
	const struct region_map *map = view->map;
	const double s = BESIDE * e->a;
	struct ellipse best = *e;
	double worth = region_worth(map, e), top = region_fit(&best, map);
	x[ODDS_ONE] = 1;
	x[ODDS_SCATTER] = rim->coverage > 0 ? log(rim->rms / e->a + FLOOR) : 0;
	x[ODDS_COVERAGE] = rim->coverage;
	x[ODDS_SIGMA] = log(odds_sigma(rim) + FLOOR);
	x[ODDS_CONTRAST] = log(fmax(rim->contrast, 0.01));
	x[ODDS_BLUR] = fmin(rim->width / e->a, 0.3);
	x[ODDS_SCLERA_OUTSIDE] = beside(evidence, EVIDENCE_SCLERA, rim, s, rim->used);
	x[ODDS_IRIS_INSIDE] = beside(evidence, EVIDENCE_IRIS, rim, -s, rim->used);
	x[ODDS_IRIS_OUTSIDE] = beside(evidence, EVIDENCE_IRIS, rim, s, 0);
	x[ODDS_SCLERA_INSIDE] = beside(evidence, EVIDENCE_SCLERA, rim, -s, 0);
	x[ODDS_EYE] = between(evidence, EVIDENCE_IRIS, e, 0, 1) + between(evidence, EVIDENCE_PUPIL, e, 0, 1)
	              + between(evidence, EVIDENCE_REFLECTION, e, 0, 1);
	x[ODDS_SCLERA] = between(evidence, EVIDENCE_SCLERA, e, 0, 1);
	x[ODDS_AROUND] = between(evidence, EVIDENCE_SCLERA, e, 1.05, 1.5);
	x[ODDS_BEHIND] = fmin(fmax(top - worth, 0) / UNIT, 4);
	x[ODDS_OFF] = fmin(fmax(hypot(best.cx - e->cx, best.cy - e->cy) / e->a, fmax(fabs(log(best.a / e->a)), fabs(log(best.b / e->b)))), 1);
	x[ODDS_PUPIL] = pupil != 0;
	x[ODDS_PUPIL_OFF] = pupil ? hypot(pupil->e.cx - e->cx, pupil->e.cy - e->cy) / e->a : 0;
	x[ODDS_PUPIL_LARGE] = pupil ? fmax(pupil->e.a / e->a - 0.5, 0) : 0;
	x[ODDS_CUT] = beyond(e, view->width, view->height);
	x[ODDS_ROUND] = log(e->b / e->a);
	x[ODDS_IRIS_EVEN] = varies(rim, false);
	x[ODDS_SCLERA_EVEN] = varies(rim, true);
	x[ODDS_SIZE] = log(e->a);
	x[ODDS_BY_STRIP] = view->by_strip;
	x[ODDS_BY_VOTES] = view->by_votes;
	of_strip(x, e, view);
}
