#include "limbus/propose/lean.h"

#include <math.h>
#include <string.h>

#include "limbus/propose/seek.h"

enum { BINS = 40, ROUNDS = 6 };
static const double FIRST = 0.72, LAST = 1.04;     // radii on the iris that are compared, of the limbus'
static const double BAND = 0.26;                   // of the semi-axis, inwards
/* Streaks and crypts make neighbours alike: a stretch of this many arcs and the whole depth of the band counts as
 * one observation. */
static const double ALIKE_ARCS = 6;
static const double CLIP = 0.35;                   // of log brightness: glints, crypts, lashes

void band_sample(struct band *band, const struct pyramid *pyramid, const struct rim *limbus)
{
	const struct ellipse *e = &limbus->e;
	const struct grey *g = &pyramid->bright[pyramid_index(pyramid, e->a, 250)];
	const double from = 2.2 * limbus->width + g->scale, to = BAND * e->b;
	for (int i = 0; i < BAND_ARCS; i++) {
		double p[2], n[2];
		ellipse_point(p, n, e, 2 * M_PI * i / BAND_ARCS);
		for (int j = 0; j < BAND_DEPTH; j++) {
			double s = from + (to - from) * j / (BAND_DEPTH - 1);
			for (int c = 0; c < 2; c++)
				band->p[i][j][c] = p[c] - s * n[c];
			band->value[i][j] = logf(fmaxf(grey_at(g, band->p[i][j][0], band->p[i][j][1]), 0.02f));
		}
		/* the rim's arcs are equally spaced along the ellipse, these in its angle: near enough to look up lids */
		double best = INFINITY;
		for (int k = 0; k < ARCS; k++) {
			double d = hypot(limbus->p[k][0] - p[0], limbus->p[k][1] - p[1]);
			if (d < best) {
				best = d;
				band->use[i] = limbus->used[k];
			}
		}
	}
}

/* Radius on the iris plane seen at each sample, in bins; -1 where it is not compared. */
static void radii(short bin[BAND_ARCS][BAND_DEPTH], const struct band *band, const struct camera *camera,
                  const double pose[4][4], const struct eye *eye)
{
	struct fit fit = { .camera = *camera };
	memcpy(fit.cam_from_eye, pose, sizeof fit.cam_from_eye);
	struct cornea cornea = eye_cornea(eye);
	cornea.rim *= 1.05;
	for (int i = 0; i < BAND_ARCS; i++)
		for (int j = 0; j < BAND_DEPTH; j++) {
			double origin[3], dir[3], K[3], from[3], in[3];
			bin[i][j] = -1;
			if (!band->use[i])
				continue;
			fit_ray(origin, dir, &fit, band->p[i][j]);
			if (!cornea_sight(K, from, in, &cornea, origin, dir) || !(in[2] > 0))
				continue;
			double t = (eye->iris_depth - from[2]) / in[2];
			double r = hypot(from[0] + t * in[0], from[1] + t * in[1]) / eye->limbus_radius;
			if (r >= FIRST && r < LAST)
				bin[i][j] = (short)((r - FIRST) / (LAST - FIRST) * BINS);
		}
}

/* Mean clipped square of what a common radial profile and each arc's own brightness leave unexplained. */
static double unexplained(const struct band *band, const short bin[BAND_ARCS][BAND_DEPTH], const bool use[BAND_ARCS])
{
	double profile[BINS] = { 0 }, own[BAND_ARCS] = { 0 }, ss = 0;
	int n = 0;
	for (int round = 0; round < ROUNDS; round++) {
		double sum[BINS] = { 0 }, weight[BINS] = { 0 };
		ss = 0;
		n = 0;
		for (int i = 0; i < BAND_ARCS; i++) {
			double mine = 0;
			int count = 0;
			for (int j = 0; j < BAND_DEPTH && use[i]; j++) {
				const int b = bin[i][j];
				if (b < 0)
					continue;
				double res = band->value[i][j] - profile[b] - own[i];
				double cut = fmin(fmax(res, -CLIP), CLIP);
				sum[b] += cut + profile[b];
				weight[b]++;
				mine += cut;
				count++;
				ss += cut * cut;
				n++;
			}
			if (count)
				own[i] += mine / count;
		}
		for (int b = 0; b < BINS; b++)
			if (weight[b] > 0)
				profile[b] = sum[b] / weight[b];
	}
	return n ? ss / n : INFINITY;
}

double lean_iris(const struct band *band, const struct camera *camera, const double a[4][4], const double b[4][4],
                 const struct eye *eye)
{
	short bin_a[BAND_ARCS][BAND_DEPTH], bin_b[BAND_ARCS][BAND_DEPTH];
	radii(bin_a, band, camera, a, eye);
	radii(bin_b, band, camera, b, eye);
	int n = 0;
	for (int i = 0; i < BAND_ARCS; i++)
		n += band->use[i];
	double ss_a = unexplained(band, bin_a, band->use), ss_b = unexplained(band, bin_b, band->use);
	if (!(ss_a > 0) || !(ss_b > 0) || !isfinite(ss_a + ss_b))
		return 0;
	return 0.5 * n * (ARCS / BAND_ARCS) / ALIKE_ARCS * log(ss_b / ss_a);
}
