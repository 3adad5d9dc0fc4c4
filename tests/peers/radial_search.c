#include "tests/peers/radial_search.h"

#include <math.h>
#include <stdlib.h>

#include "base/mem.h"
#include "math/ellipse_fit.h"

enum { RAYS = 90, SMALL = 200 };

void radial_shrink(uint8_t **out, const uint8_t *g, int width, int height, int n)
{
	const int w = width / n, h = height / n;
	*out = mem_array((size_t)w * (size_t)h, 1);
	for (int y = 0; y < h; y++)
		for (int x = 0; x < w; x++) {
			int sum = 0;
			for (int k = 0; k < n * n; k++)
				sum += g[(long)(y * n + k / n) * width + x * n + k % n];
			(*out)[y * w + x] = (uint8_t)(sum / (n * n));
		}
}

static double at(const uint8_t *g, int w, int h, double x, double y)
{
	const int i = (int)floor(x), j = (int)floor(y);
	return i < 0 || j < 0 || i >= w || j >= h ? NAN : g[(long)j * w + i];
}

/* How much brighter the sides are than the disc. */
static double contrast(const uint8_t *g, int w, int h, double x, double y, double r)
{
	double in = 0, out = INFINITY;
	for (int side = -1; side <= 1; side += 2) {
		double sum = 0;
		for (int k = -3; k <= 3; k++) {
			sum += at(g, w, h, x + 1.25 * side * r * cos(0.15 * k), y + 1.25 * r * sin(0.15 * k));
			in += at(g, w, h, x + 0.7 * side * r * cos(0.15 * k), y + 0.7 * r * sin(0.15 * k));
		}
		out = sum / 7 < out || isnan(sum) ? sum / 7 : out;
	}
	return out - in / 14;
}

/* The strongest step along rays within 50 degrees of the horizontal, from (1 - reach) to (1 + reach) of the ellipse. Returns how many
 * agree on an ellipse; 0: none. */
static double rays(struct ellipse *e, const uint8_t *g, int w, int h, double reach)
{
	double p[RAYS][2], span = fmax(0.06 * e->a, 1.5);
	int n = 0;
	for (int k = 0; k < RAYS; k++) {
		const double turn = (k < RAYS / 2 ? 0 : M_PI) + ((k % (RAYS / 2)) * 2.0 / (RAYS / 2) - 1) * 0.87, dx = cos(turn), dy = sin(turn);
		const double u = cos(turn - e->angle) / e->a, v = sin(turn - e->angle) / e->b, r = 1 / hypot(u, v);
		double best = 0;
		for (double s = r * (1 - reach); s <= r * (1 + reach); s += fmax(r / 200, 0.25)) {
			double step = 0;
			for (int i = 1; i <= 5; i++)
				step += at(g, w, h, e->cx + dx * (s + span * i / 5), e->cy + dy * (s + span * i / 5)) - at(g, w, h, e->cx + dx * (s - span * i / 5), e->cy + dy * (s - span * i / 5));
			if (step > best) {
				best = step;
				p[n][0] = e->cx + dx * s;
				p[n][1] = e->cy + dy * s;
			}
		}
		n += best > 40;
	}
	struct ellipse_fit fit;
	struct ellipse found;
	if (n < RAYS / 3 || !ellipse_fit_robust(&found, &fit, n, (const double (*)[2])p, 0, 0, 0, false) || fit.inliers < 0.4 || found.b < 0.5 * found.a)
		return 0;
	*e = found;
	return n * fit.inliers;
}

bool radial_search(struct ellipse *e, const uint8_t *grey, int width, int height, double r_min, double r_max)
{
	const int n = (width > height ? width : height) / SMALL + 1, w = width / n, h = height / n;
	uint8_t *g;
	double most = 0;
	radial_shrink(&g, grey, width, height, n);
	for (double r = fmax(r_min / n, 4); r <= r_max / n; r *= 1.12) {
		struct ellipse one = { 0, 0, r, r, 0 };
		double best = 0;
		for (double y = 0; y < h; y += fmax(r / 8, 1))
			for (double x = 0; x < w; x += fmax(r / 8, 1)) {
				const double c = contrast(g, w, h, x, y, r);
				if (c > best) {
					best = c;
					one.cx = x;
					one.cy = y;
				}
			}
		const double agree = best > 0 ? best * rays(&one, g, w, h, 0.25) : 0;
		if (agree > most) {
			most = agree;
			*e = (struct ellipse){ n * one.cx, n * one.cy, n * one.a, n * one.b, one.angle };
		}
	}
	free(g);
	return most > 0 && rays(e, grey, width, height, 0.08) > 0;
}
