#include "tests/peers/swirski.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "math/ellipse_fit.h"
#include "math/rng.h"

enum { SAMPLE = 5, ROUNDS = 400, POINTS_MAX = 4000 };

struct grid { const uint8_t *g; int w, h; };
struct region { int x0, y0, x1, y1; };
struct edge { double p[2], gradient[2]; };

/* sum[(h + 1)][(w + 1)] of all pixels above and to the left. */
static long *integral(const struct grid *i)
{
	long *sum = mem_new((size_t)(i->w + 1) * (size_t)(i->h + 1), sizeof *sum);
	for (int y = 0; y < i->h; y++) {
		long row = 0;
		for (int x = 0; x < i->w; x++) {
			row += i->g[y * i->w + x];
			sum[(y + 1) * (i->w + 1) + x + 1] = sum[y * (i->w + 1) + x + 1] + row;
		}
	}
	return sum;
}

static double mean(const long *sum, const struct grid *i, int x, int y, int r, long *n)
{
	const int x0 = x - r > 0 ? x - r : 0, y0 = y - r > 0 ? y - r : 0, x1 = x + r < i->w ? x + r : i->w, y1 = y + r < i->h ? y + r : i->h, w = i->w + 1;
	*n = (long)(x1 - x0) * (y1 - y0);
	return (double)(sum[y1 * w + x1] - sum[y0 * w + x1] - sum[y1 * w + x0] + sum[y0 * w + x0]);
}

/* The Haar-like feature: a square of side 2 r within one of 6 r, for all radii: the largest difference of the means. */
static double surround(int best[3], const struct grid *i, double r_min, double r_max)
{
	long *sum = integral(i);
	double most = 0;
	for (double r = r_min; r <= r_max; r *= 1.15)
		for (int y = (int)r; y < i->h - (int)r; y += 1 + (int)(r / 12))
			for (int x = (int)r; x < i->w - (int)r; x += 1 + (int)(r / 12)) {
				long n_in, n_all;
				const double in = mean(sum, i, x, y, (int)r, &n_in), all = mean(sum, i, x, y, 3 * (int)r, &n_all);
				if (n_all <= n_in)
					continue;
				const double response = (all - in) / (double)(n_all - n_in) - in / (double)n_in;
				if (response > most) {
					most = response;
					best[0] = x;
					best[1] = y;
					best[2] = (int)r;
				}
			}
	free(sum);
	return most;
}

/* The level between two means of the region's histogram (k-means, k = 2). */
static int threshold(const struct grid *i, const struct region *r)
{
	long count[256] = { 0 };
	for (int y = r->y0; y < r->y1; y++)
		for (int x = r->x0; x < r->x1; x++)
			count[i->g[y * i->w + x]]++;
	double low = 0, high = 255;
	for (int round = 0; round < 30; round++) {
		double sum[2] = { 0 }, n[2] = { 1e-9, 1e-9 };
		for (int v = 0; v < 256; v++) {
			const int side = fabs(v - low) > fabs(v - high);
			sum[side] += (double)count[v] * v;
			n[side] += (double)count[v];
		}
		low = sum[0] / n[0];
		high = sum[1] / n[1];
	}
	return (int)((low + high) / 2);
}

/* Edge pixels of the dark region: dark with a bright neighbour; the gradient of the picture there. */
static int edges(struct edge *out, const struct grid *i, const struct region *r, int level)
{
	int n = 0;
	for (int y = r->y0 + 2; y < r->y1 - 2; y++)
		for (int x = r->x0 + 2; x < r->x1 - 2; x++) {
			const uint8_t *g = i->g + (long)y * i->w + x;
			const int w = i->w;
			if (g[0] > level || (g[-1] <= level && g[1] <= level && g[-w] <= level && g[w] <= level) || n == POINTS_MAX)
				continue;
			const double dx = g[1 - w] + 2 * g[1] + g[1 + w] - g[-1 - w] - 2 * g[-1] - g[-1 + w];
			const double dy = g[w - 1] + 2 * g[w] + g[w + 1] - g[-w - 1] - 2 * g[-w] - g[-w + 1], size = hypot(dx, dy);
			if (size > 40)
				out[n++] = (struct edge){ { x + 0.5, y + 0.5 }, { dx / size, dy / size } };
		}
	return n;
}

/* Inliers within a px and a half, each by how well the ellipse's normal agrees with the gradient. */
static double support(const struct ellipse *e, int n, const struct edge *edge, double (*in)[2], int *n_in)
{
	double sum = 0;
	*n_in = 0;
	for (int k = 0; k < n; k++) {
		const double dx = edge[k].p[0] - e->cx, dy = edge[k].p[1] - e->cy, c = cos(e->angle), s = sin(e->angle);
		const double u = (c * dx + s * dy) / (e->a * e->a), v = (c * dy - s * dx) / (e->b * e->b), size = hypot(u, v);
		const double q = u * (c * dx + s * dy) + v * (c * dy - s * dx), off = (q - 1) / (2 * size);
		const double agrees = ((c * u - s * v) * edge[k].gradient[0] + (s * u + c * v) * edge[k].gradient[1]) / size;
		if (fabs(off) > 1.5 || agrees < 0.5)
			continue;
		sum += agrees;
		in[*n_in][0] = edge[k].p[0];
		in[(*n_in)++][1] = edge[k].p[1];
	}
	return sum;
}

static bool ransac(struct ellipse *e, int n, const struct edge *edge, double r_min, double r_max)
{
	static double in[POINTS_MAX][2];
	struct rng rng = { 1 };
	double best = 0;
	for (int round = 0; round < ROUNDS; round++) {
		double p[SAMPLE][2];
		for (int k = 0; k < SAMPLE; k++)
			memcpy(p[k], edge[rng_below(&rng, n)].p, sizeof p[k]);
		struct ellipse fit;
		int n_in;
		if (!ellipse_fit_direct(&fit, SAMPLE, (const double (*)[2])p, 0) || fit.a > r_max || fit.b < r_min || fit.b < 0.4 * fit.a)
			continue;
		double worth = support(&fit, n, edge, in, &n_in);
		struct ellipse again = fit;
		if (n_in >= SAMPLE && ellipse_fit_direct(&again, n_in, (const double (*)[2])in, 0) && again.a <= r_max && again.b > 0.4 * again.a) {
			fit = again;
			worth = support(&fit, n, edge, in, &n_in);
		}
		// Per length of the ellipse's margin: a large one has more pixels.
		worth /= M_PI * (fit.a + fit.b);
		if (worth > best) {
			best = worth;
			*e = fit;
		}
	}
	return best > 0.2;
}

bool swirski_ellipse(struct ellipse *e, const uint8_t *grey, int width, int height, double r_min, double r_max)
{
	const struct grid i = { grey, width, height };
	int best[3] = { 0 };
	if (surround(best, &i, r_min, r_max) <= 0)
		return false;
	const int reach = (int)(1.8 * best[2]);
	const struct region r = { best[0] > reach ? best[0] - reach : 0, best[1] > reach ? best[1] - reach : 0, best[0] + reach < width ? best[0] + reach : width,
		best[1] + reach < height ? best[1] + reach : height };
	struct edge *edge = mem_array(POINTS_MAX, sizeof *edge);
	const int n = edges(edge, &i, &r, threshold(&i, &r));
	const bool ok = n > 20 && ransac(e, n, edge, r_min, r_max);
	free(edge);
	return ok;
}
