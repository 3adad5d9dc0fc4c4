#include "limbus/region.h"

#include <math.h>
#include <stdlib.h>

#include "base/mem.h"

static const double HIDDEN = 0.85;  // chance that skin or lashes lie over the iris, against their chance outside
static const double FLOOR = 0.02;   // the evidence is never surer
static const double ROUND = 0.2;    // spread of log(a / b)

struct region_map region_map_make(const struct evidence *e)
{
	struct region_map m = { e->width, e->height, e->x0, e->y0, e->scale, 0 };
	m.sum = mem_array((size_t)(m.width + 1) * (size_t)m.height, sizeof *m.sum);
	for (int y = 0; y < m.height; y++) {
		float *row = m.sum + (long)y * (m.width + 1);
		row[0] = 0;
		for (int x = 0; x < m.width; x++) {
			const long i = (long)y * m.width + x;
			const double hidden = e->plane[EVIDENCE_SKIN][i] + e->plane[EVIDENCE_LASH][i], mirror = e->plane[EVIDENCE_REFLECTION][i];
			const double in = e->plane[EVIDENCE_IRIS][i] + e->plane[EVIDENCE_PUPIL][i] + mirror + HIDDEN * hidden;
			const double out = e->plane[EVIDENCE_SCLERA][i] + 0.4 * mirror + hidden;
			row[x + 1] = row[x] + (float)log((in + FLOOR) / (out + FLOOR));
		}
	}
	return m;
}

void region_map_free(struct region_map *map)
{
	free(map->sum);
	map->sum = 0;
}

static double upto(const float *row, int width, double x)
{
	x = fmin(fmax(x, 0), width - 1e-6);
	const int i = (int)x;
	return row[i] + (x - i) * (row[i + 1] - row[i]);
}

double region_worth(const struct region_map *m, const struct ellipse *e)
{
	// Rows of the map cut the ellipse in chords: x = mid(y) +- half(y).
	const double c = cos(e->angle), s = sin(e->angle), a2 = e->a * e->a, b2 = e->b * e->b;
	const double yy = a2 * s * s + b2 * c * c, xy = (a2 - b2) * c * s, ab = e->a * e->b;
	const double cy = (e->cy - m->y0) / m->scale, cx = (e->cx - m->x0) / m->scale, high = sqrt(yy) / m->scale;
	double sum = 0;
	for (int y = (int)fmin(fmax(ceil(cy - high - 0.5), 0), m->height); y < m->height && y + 0.5 < cy + high; y++) {
		const double v = (y + 0.5 - cy) * m->scale, left = yy - v * v;
		if (left <= 0)
			continue;
		const double mid = cx + xy / yy * v / m->scale, half = ab / yy * sqrt(left) / m->scale;
		const float *row = m->sum + (long)y * (m->width + 1);
		sum += upto(row, m->width, mid + half) - upto(row, m->width, mid - half);
	}
	const double unit = 20 * m->scale, size = fmin(e->a * e->b / (unit * unit), 1);
	return sum - 300 * size * pow(log(e->a / e->b) / ROUND, 2) * 0.5;
}

static double worth(const void *ctx, const struct ellipse *e)
{
	return region_worth(ctx, e);
}

double region_fit(struct ellipse *e, const struct region_map *map)
{
	const double r = e->a;
	return ellipse_climb(e, 0.16 * r, 0.005 * r, 0.5, worth, map);
}

double region_shown(const struct ellipse *e, const struct evidence *evidence)
{
	enum { PLACES = 72 };
	static const double BESIDE = 1.09;
	const struct ellipse wider = { e->cx, e->cy, BESIDE * e->a, BESIDE * e->b, e->angle };
	double sum = 0;
	for (int i = 0; i < PLACES; i++) {
		double p[2], normal[2];
		ellipse_point(p, normal, &wider, 2 * M_PI * i / PLACES);
		sum += evidence_at(evidence, EVIDENCE_SCLERA, p[0], p[1]);
	}
	return sum / PLACES;
}

struct grey region_sclera(const struct evidence *e)
{
	const long n = (long)e->width * e->height;
	struct grey g = { e->width, e->height, e->x0, e->y0, e->scale, mem_array((size_t)n, sizeof *g.px), 0 };
	for (long i = 0; i < n; i++)
		g.px[i] = e->plane[EVIDENCE_SCLERA][i] + 0.5F * (e->plane[EVIDENCE_REFLECTION][i] + e->plane[EVIDENCE_IRIS][i]) + 0.02F;
	return g;
}
