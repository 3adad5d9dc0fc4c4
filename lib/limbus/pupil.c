#include "limbus/pupil.h"

#include <math.h>

#include "limbus/propose/score.h"
#include "limbus/propose/seek.h"
#include "math/stats.h"

enum { RADII = 16, GRID = 2, SAMPLES = 24 };
static const double CONTRAST = 0.12;

static double ring_median(const struct grey *g, const struct ellipse *e, double scale, double quantile)
{
	double v[SAMPLES];
	struct ellipse f = *e;
	f.a *= scale;
	f.b *= scale;
	for (int i = 0; i < SAMPLES; i++) {
		double p[2], n[2];
		ellipse_point(p, n, &f, 2 * M_PI * (i + 0.5) / SAMPLES);
		v[i] = grey_at(g, p[0], p[1]);
	}
	return stats_quantile(SAMPLES, v, quantile);
}

/* Edge score, less where the inside is not one dark level from the middle to the margin (collarette, dark ring). */
static double pupil_score(const struct grey *g, const struct ellipse *e)
{
	double edge = score_ellipse(g, e, CONTRAST, SCORE_WIDE);
	double core = ring_median(g, e, 0.4, 0.5), rim = ring_median(g, e, 0.85, 0.6), out = ring_median(g, e, 1.15, 0.5);
	if (!(out > core))
		return 0;
	double even = 1 - fmax(rim - core, 0) / (out - core);
	return edge * fmax(even, 0);
}

/* The best circle, or copy of the limbus' shape, on a grid of centres and radii. */
static double search(struct ellipse *best, const struct pyramid *pyramid, const struct ellipse *limbus)
{
	double top = 0;
	for (int i = 0; i < RADII; i++) {
		double k = 0.12 * pow(0.78 / 0.12, (double)i / (RADII - 1)), reach = 0.07 * limbus->b;
		const struct grey *g = &pyramid->bright[pyramid_index(pyramid, k * limbus->a, 40)];
		for (int x = -GRID; x <= GRID; x++)
			for (int y = -GRID; y <= GRID; y++) {
				struct ellipse e = { limbus->cx + x * reach, limbus->cy + y * reach, k * limbus->a, k * limbus->b,
				                     limbus->angle };
				double score = pupil_score(g, &e);
				if (score > top) {
					top = score;
					*best = e;
				}
			}
	}
	return top;
}

bool limbus_pupil(struct rim *pupil, const struct photo *photo, const struct pyramid *pyramid,
                  const struct ellipse *limbus, const struct rim_conf *rim_conf, const struct pupil_conf *conf)
{
	struct ellipse e;
	if (search(&e, pyramid, limbus) < 0.2)
		return false;
	score_climb(&pyramid->bright[pyramid_index(pyramid, e.a, 60)], &e, 0.08 * e.a, 0.01 * e.a, CONTRAST, SCORE_WIDE);
	struct rim_conf grey = *rim_conf;
	grey.grey = true;
	grey.search = fmax(grey.search, 6 / e.a);
	if (!rim_fit(pupil, photo, 0, &e, &grey))
		return false;
	double off = hypot(pupil->e.cx - limbus->cx, pupil->e.cy - limbus->cy);
	return off + pupil->e.a < limbus->a && pupil->contrast > conf->min_contrast && pupil->coverage > conf->min_coverage;
}
