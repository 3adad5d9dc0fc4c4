#include "tests/lib/cast/cast_impl.h"

void cast_project(double px[2], const struct cast *c, struct vec p)
{
	const struct vec r = add(p, -1, c->camera);
	const double z = dot(r, c->look[2]);
	px[0] = c->mid[0] + c->focal * dot(r, c->look[0]) / z;
	px[1] = c->mid[1] + c->focal * dot(r, c->look[1]) / z;
}

/* A stroke from a to b, px, of half widths ra and rb. */
static void stroke(struct cast *c, const double a[2], const double b[2], double ra, double rb)
{
	const int w = c->frame->width, h = c->frame->height;
	const double reach = fmax(ra, rb) + 1, dx = b[0] - a[0], dy = b[1] - a[1], length = fmax(dx * dx + dy * dy, 1e-9);
	const int x0 = (int)fmax(fmin(a[0], b[0]) - reach, 0), x1 = (int)fmin(fmax(a[0], b[0]) + reach, w - 1);
	const int y0 = (int)fmax(fmin(a[1], b[1]) - reach, 0), y1 = (int)fmin(fmax(a[1], b[1]) + reach, h - 1);
	for (int y = y0; y <= y1; y++)
		for (int x = x0; x <= x1; x++) {
			const double ex = x + 0.5 - a[0], ey = y + 0.5 - a[1], t = clamp((ex * dx + ey * dy) / length, 0, 1), r = ra + t * (rb - ra);
			const double off = hypot(ex - t * dx, ey - t * dy), cover = clamp(r + 0.5 - off, 0, fmin(2 * r, 1));
			float *hair = &c->hair[(long)y * w + x];
			*hair = fmaxf(*hair, (float)cover);
		}
}

static void hair(struct cast *c, struct vec a, struct vec b, struct vec end, double width)
{
	enum { PIECES = 8 };
	double was[2], px[2];
	cast_project(was, c, a);
	for (int k = 1; k <= PIECES; k++) {
		const double t = (double)k / PIECES, u = 1 - t, far = -dot(c->camera, c->look[2]), r = 0.5 * width * c->focal / far;
		cast_project(px, c, add(add(scaled(a, u * u), 2 * u * t, b), t * t, end));
		stroke(c, was, px, r * (1.1 - (k - 1.0) / PIECES), r * (1.1 - (double)k / PIECES));
		was[0] = px[0];
		was[1] = px[1];
	}
}

static struct vec on_margin(const struct cast_lids *l, double t, int lower)
{
	const double a = l->inner[0] + t * (l->outer[0] - l->inner[0]);
	double m[2];
	cast_margins(m, l, a);
	return vec(l->shell * cos(m[lower]) * sin(a), l->shell * sin(m[lower]), l->shell * cos(m[lower]) * cos(a));
}

void cast_hairs(struct cast *c, struct rng *rng)
{
	const struct cast_lids *l = &c->lids;
	const double side = l->inner[0] < l->outer[0] ? 1 : -1, width = rng_range(rng, 0.06, 0.14), curl = rng_range(rng, 0.1, 0.8), mess = rng_range(rng, 0.05, 0.3);
	for (int lower = 0; lower < 2; lower++) {
		const int n = rng_below(rng, 8) ? (lower ? 15 + rng_below(rng, 45) : 40 + rng_below(rng, 90)) : 0;
		const double length = lower ? rng_range(rng, 2.5, 5.5) : rng_range(rng, 4.5, 10), droop = lower ? 0.7 : rng_range(rng, -0.35, 0.25);
		for (int k = 0; k < n; k++) {
			const double t = rng_range(rng, 0.1, 0.98), size = length * rng_range(rng, 0.6, 1.1) * (0.7 + 0.5 * t * (1.2 - t));
			const struct vec a = on_margin(l, t, lower), out = unit(a);
			const double fan = side * (1.6 * (t - 0.5)) + mess * rng_normal(rng), way = lower ? -1 : 1;
			const struct vec b = add(add(a, 0.5 * size, out), 0.5 * size, vec(0.4 * fan, way * (lower ? 0.5 : -droop), 0));
			const struct vec end = add(add(a, 0.75 * size, out), size, vec(fan, way * (curl + (lower ? 0.4 : -0.5 * droop)), 0));
			hair(c, a, b, end, width * rng_range(rng, 0.7, 1.1));
		}
	}
	const int brow = rng_below(rng, 4) ? 120 + rng_below(rng, 250) : 0;
	const double high = rng_range(rng, 14, 21), thick = rng_range(rng, 1.2, 3.2);
	for (int k = 0; k < brow; k++) {
		const double u = rng_range(rng, -16, 19), v = high + 0.1 * u - 0.012 * u * u + thick * rng_normal(rng) * (1.2 - 0.03 * (u + 16));
		const struct vec a = vec(side * u, v, 15), end = vec(side * (u + rng_range(rng, 3, 7)), v + (u < 5 ? 2 : -1) + 0.8 * rng_normal(rng), 16);
		hair(c, a, scaled(add(a, 1, end), 0.5), end, 1.1 * width);
	}
}
