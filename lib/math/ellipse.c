#include "math/ellipse.h"

#include <math.h>
#include <string.h>

void ellipse_to_q(double q[ELLIPSE_N], const struct ellipse *e)
{
	double d = (e->a - e->b) / 2;
	q[0] = e->cx;
	q[1] = e->cy;
	q[2] = (e->a + e->b) / 2;
	q[3] = d * cos(2 * e->angle);
	q[4] = d * sin(2 * e->angle);
}

void ellipse_span(double d[2], const struct ellipse *e, double x, double y)
{
	double q[ELLIPSE_N];
	ellipse_to_q(q, e);
	d[0] = (q[2] + q[3]) * x + q[4] * y;
	d[1] = q[4] * x + (q[2] - q[3]) * y;
}

bool ellipse_from_q(struct ellipse *e, const double q[ELLIPSE_N])
{
	double d = hypot(q[3], q[4]);
	double angle = atan2(q[4], q[3]) / 2;
	*e = (struct ellipse){ q[0], q[1], q[2] + d, q[2] - d, angle < 0 ? angle + M_PI : angle };
	return isfinite(q[0] + q[1] + e->a + angle) && e->b > 0;
}

void ellipse_sigma(double sigma[ELLIPSE_N], const struct ellipse *e, const double cov_q[ELLIPSE_N][ELLIPSE_N])
{
	const double c = cos(2 * e->angle), s = sin(2 * e->angle);
	double along = c * c * cov_q[3][3] + 2 * c * s * cov_q[3][4] + s * s * cov_q[4][4];
	double across = s * s * cov_q[3][3] - 2 * c * s * cov_q[3][4] + c * c * cov_q[4][4];
	double mixed = c * cov_q[2][3] + s * cov_q[2][4];
	sigma[0] = sqrt(cov_q[0][0]);
	sigma[1] = sqrt(cov_q[1][1]);
	sigma[2] = sqrt(fmax(cov_q[2][2] + along + 2 * mixed, 0));
	sigma[3] = sqrt(fmax(cov_q[2][2] + along - 2 * mixed, 0));
	sigma[4] = fmin(sqrt(fmax(across, 0)) / fmax(e->a - e->b, 1e-12), M_PI / sqrt(12));
}

/* With the cosine and the sine of its angle. */
static inline void point(double p[2], double normal[2], const struct ellipse *e, double c, double s, double t)
{
	const double ct = cos(t), st = sin(t);
	double x = e->a * ct, y = e->b * st;
	double nx = e->b * ct, ny = e->a * st, n = hypot(nx, ny);
	p[0] = e->cx + c * x - s * y;
	p[1] = e->cy + s * x + c * y;
	normal[0] = (c * nx - s * ny) / n;
	normal[1] = (s * nx + c * ny) / n;
}

void ellipse_point(double p[2], double normal[2], const struct ellipse *e, double t)
{
	point(p, normal, e, cos(e->angle), sin(e->angle), t);
}

void ellipse_points(int n, double p[n][2], double normal[n][2], const struct ellipse *e, const double t[n])
{
	const double c = cos(e->angle), s = sin(e->angle);
	for (int i = 0; i < n; i++)
		point(p[i], normal[i], e, c, s, t[i]);
}

static inline double distance(double *t, const struct ellipse *e, double c, double s, const double p[2])
{
	const double dx = p[0] - e->cx, dy = p[1] - e->cy;
	const double a = e->a, b = e->b, k = a * a - b * b;
	const double x = fabs(c * dx + s * dy), y = fabs(c * dy - s * dx);
	/* First quadrant. f(u) = (a² - b²) cos u sin u - x a sin u + y b cos u falls through its root there, except for
	 * points near the major axis inside the evolute; bisection guards Newton. */
	double lo = 0, hi = M_PI / 2, u = atan2(a * y, b * x);
	for (int i = 0; i < 60; i++) {
		double cu = cos(u), su = sin(u);
		double f = k * cu * su - x * a * su + y * b * cu;
		if (f > 0)
			lo = u;
		else
			hi = u;
		double step = f / (k * (cu * cu - su * su) - x * a * cu - y * b * su);
		if (fabs(step) < 1e-8) {  // quadratic: what is left is 1e-16
			u -= step;
			break;
		}
		double next = u - step;
		if (!(next > lo && next < hi))
			next = (lo + hi) / 2;
		u = next;
	}
	double fx = a * cos(u), fy = b * sin(u);
	double d = hypot(x - fx, y - fy);
	double inside = x * x / (a * a) + y * y / (b * b);
	double tx = c * dx + s * dy < 0 ? M_PI - u : u;
	*t = c * dy - s * dx < 0 ? -tx : tx;
	return inside < 1 ? -d : d;
}

double ellipse_distance(double *t, const struct ellipse *e, const double p[2])
{
	return distance(t, e, cos(e->angle), sin(e->angle), p);
}

void ellipse_distances(int n, double d[n], double t[n], const struct ellipse *e, const double p[n][2])
{
	const double c = cos(e->angle), s = sin(e->angle);
	for (int i = 0; i < n; i++)
		d[i] = distance(&t[i], e, c, s, p[i]);
}

void ellipse_normal_shift(double row[ELLIPSE_N], const struct ellipse *e, double t)
{
	double p[2], n[2];
	ellipse_point(p, n, e, t);
	ellipse_shift_along(row, n, e, t);
}

void ellipse_shift_along(double row[ELLIPSE_N], const double n[2], const struct ellipse *e, double t)
{
	const double ux = cos(e->angle + t), uy = sin(e->angle + t);
	row[0] = n[0];
	row[1] = n[1];
	row[2] = n[0] * ux + n[1] * uy;
	row[3] = n[0] * ux - n[1] * uy;
	row[4] = n[0] * uy + n[1] * ux;
}

bool ellipse_from_conic(struct ellipse *e, const double k[6])
{
	double det = 4 * k[0] * k[2] - k[1] * k[1];
	if (!(det > 0))
		return false;
	double cx = (k[1] * k[4] - 2 * k[2] * k[3]) / det, cy = (k[1] * k[3] - 2 * k[0] * k[4]) / det;
	double f = k[5] + (k[3] * cx + k[4] * cy) / 2;
	double sum = k[0] + k[2], diff = hypot(k[0] - k[2], k[1]);
	double sign = sum > 0 ? 1 : -1;
	double large = sign * (sum + sign * diff) / 2, small = (det / 4) / large;
	double scale = -f * sign;
	if (!(scale > 0) || !(small > 0))
		return false;
	double angle = atan2(-sign * k[1], -sign * (k[0] - k[2])) / 2, a = sqrt(scale / small);
	*e = (struct ellipse){ cx, cy, a, fmin(a, sqrt(scale / large)), angle < 0 ? angle + M_PI : angle };
	return isfinite(cx + cy + e->a + e->b);
}

void ellipse_to_conic(double k[6], const struct ellipse *e)
{
	const double c = cos(e->angle), s = sin(e->angle), ia = 1 / (e->a * e->a), ib = 1 / (e->b * e->b);
	k[0] = c * c * ia + s * s * ib;
	k[1] = 2 * c * s * (ia - ib);
	k[2] = s * s * ia + c * c * ib;
	k[3] = -2 * k[0] * e->cx - k[1] * e->cy;
	k[4] = -2 * k[2] * e->cy - k[1] * e->cx;
	k[5] = k[0] * e->cx * e->cx + k[1] * e->cx * e->cy + k[2] * e->cy * e->cy - 1;
}

double ellipse_perimeter(const struct ellipse *e)
{
	double h = (e->a - e->b) * (e->a - e->b) / ((e->a + e->b) * (e->a + e->b));
	return M_PI * (e->a + e->b) * (1 + 3 * h / (10 + sqrt(4 - 3 * h)));
}

enum { CLIMB_ROUNDS = 1000 };  // a hill without a top has an end

double ellipse_climb(struct ellipse *e, double step, double end, double least_aspect,
                     double (*worth)(const void *ctx, const struct ellipse *e), const void *ctx)
{
	double q[ELLIPSE_N], best = worth(ctx, e);
	ellipse_to_q(q, e);
	for (int round = 0; step > end && round < CLIMB_ROUNDS; round++) {
		bool moved = false;
		for (int i = 0; i < 2 * ELLIPSE_N; i++) {
			double try[ELLIPSE_N];
			struct ellipse f;
			memcpy(try, q, sizeof try);
			try[i / 2] += i % 2 ? -step : step;
			if (!ellipse_from_q(&f, try) || f.b < least_aspect * f.a)
				continue;
			double now = worth(ctx, &f);
			if (now > best + 1e-9) {
				best = now;
				memcpy(q, try, sizeof q);
				*e = f;
				moved = true;
			}
		}
		if (!moved)
			step /= 2;
	}
	return best;
}

double ellipse_apart(const struct ellipse *e, const struct ellipse *f)
{
	return fmax(hypot(e->cx - f->cx, e->cy - f->cy), fmax(fabs(e->a - f->a), fabs(e->b - f->b)));
}
