/* integro: Daugman's integro-differential operator, as a baseline: the circle over which the mean brightness changes
 * most with radius, searched coarse to fine. */
#ifndef BENCH_INTEGRO_H
#define BENCH_INTEGRO_H
#include <math.h>
#include <stdint.h>

#include "math/ellipse.h"

static inline double integro_mean(const uint8_t *g, int w, int h, double x, double y, double r)
{
	/* the sides only, as Daugman does for lids: within 45 degrees of the horizontal */
	double sum = 0;
	int n = 0;
	for (int i = -16; i <= 16; i++)
		for (int side = 0; side < 2; side++) {
			double t = i * M_PI / 64 + side * M_PI;
			int u = (int)(x + r * cos(t)), v = (int)(y + r * sin(t));
			if (u < 0 || v < 0 || u >= w || v >= h)
				continue;
			sum += g[(long)v * w + u];
			n++;
		}
	return n > 40 ? sum / n : NAN;
}

static inline bool integro_circle(struct ellipse *e, const uint8_t *g, int w, int h, double r_min, double r_max)
{
	double best = 0, x0 = w / 2.0, y0 = h / 2.0, reach_x = w / 2.0, reach_y = h / 2.0, lo = r_min, hi = r_max;
	for (double step = 8; step >= 1; step /= 2) {
		double bx = x0, by = y0, br = (lo + hi) / 2, round = 0;
		for (double y = y0 - reach_y; y <= y0 + reach_y; y += step)
			for (double x = x0 - reach_x; x <= x0 + reach_x; x += step)
				for (double r = lo; r <= hi; r += step) {
					double d = integro_mean(g, w, h, x, y, r + 2) - integro_mean(g, w, h, x, y, r - 2);
					if (d > round) {
						round = d;
						bx = x;
						by = y;
						br = r;
					}
				}
		best = round;
		x0 = bx;
		y0 = by;
		reach_x = reach_y = 1.5 * step;
		lo = fmax(br - 1.5 * step, r_min);
		hi = br + 1.5 * step;
	}
	*e = (struct ellipse){ x0, y0, (lo + hi) / 2, (lo + hi) / 2, 0 };
	return best > 0;
}

#endif
