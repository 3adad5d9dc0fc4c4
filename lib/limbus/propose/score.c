#include "limbus/propose/score.h"

#include <math.h>

enum { POINTS = 64 };

double score_ellipse(const struct grey *g, const struct ellipse *e, double contrast, enum score_reach reach)
{
	return score_ellipse_above(g, e, contrast, reach, -1);
}

double score_ellipse_above(const struct grey *g, const struct ellipse *e, double contrast, enum score_reach reach, double least)
{
	const double enough = POINTS * least - 1e-9;  // what rounding may add
	const double near = fmax((reach == SCORE_NARROW ? 0.025 : 0.05) * e->b, 1.2 * g->scale), far = fmax(0.14 * e->b, 2.5 * g->scale);
	const double c = cos(e->angle), s = sin(e->angle), step = 2 * M_PI / POINTS, cs = cos(step), ss = sin(step);
	const double w = g->width * g->scale, h = g->height * g->scale;
	double sum = 0, ct = 1, st = 0;
	for (int i = 0; i < POINTS; i++) {
		if (sum + (POINTS - i) < enough)
			return 0;
		double nx = e->b * ct, ny = e->a * st, n = sqrt(nx * nx + ny * ny);
		double ux = (c * nx - s * ny) / n, uy = (s * nx + c * ny) / n;
		double x = e->cx + c * e->a * ct - s * e->b * st, y = e->cy + s * e->a * ct + c * e->b * st;
		double t = ct * cs - st * ss;
		st = st * cs + ct * ss;
		ct = t;
		if (x < 0 || y < 0 || x > w || y > h)
			continue;
		float in = grey_at(g, x - near * ux, y - near * uy), out = grey_at(g, x + near * ux, y + near * uy);
		float in2 = grey_at(g, x - far * ux, y - far * uy), out2 = grey_at(g, x + far * ux, y + far * uy);
		/* brightness outside counts too: the sclera is light, an iris round its pupil is less so */
		double k1 = (out - in) / (out + in + 0.04), k2 = (out2 - in2) / (out2 + in2 + 0.04), k = fmin(k1, k2);
		double light = fmin(out, out2);
		if (k > 0)
			sum += fmin(k / contrast, 1) * fmin(0.4 + light, 1);
	}
	return sum / POINTS;
}

struct climb {
	const struct grey *grey;
	double contrast;
	enum score_reach reach;
};

static double worth(const void *ctx, const struct ellipse *e)
{
	const struct climb *c = ctx;
	return score_ellipse(c->grey, e, c->contrast, c->reach);
}

double score_climb(const struct grey *g, struct ellipse *e, double step, double end, double contrast, enum score_reach reach)
{
	return ellipse_climb(e, step, end, 0.55, worth, &(struct climb){ g, contrast, reach });
}
