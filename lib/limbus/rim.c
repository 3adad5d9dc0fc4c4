#include "limbus/rim.h"

#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "limbus/propose/colour.h"
#include "limbus/propose/consensus.h"
#include "limbus/cover.h"
#include "math/ellipse_fit.h"
#include "math/stats.h"

enum { MAX_LAG = ARCS / 8, MIN_ARCS = 40, WIDTH_ARCS = 24, ACROSS = 6, PASSES = 6, SMOOTH_FROM = 4, SMOOTH_TO = 8 };
static const double LEAST_NOISE = 0.02;  // px: no step is placed better
static const double SHARP_PX = 3;       // a step's sigma

static double median_of(const struct step step[ARCS], const bool use[ARCS], size_t field)
{
	double v[ARCS];
	int n = 0;
	for (int i = 0; i < ARCS; i++)
		if (use[i])
			v[n++] = *(const double *)((const char *)&step[i] + field);
	return stats_median(n, v);
}
#define MEDIAN(steps, use, field) median_of(steps, use, offsetof(struct step, field))

/* Which arcs show iris against sclera: enough contrast, a step as the others', not beside a gap. */
static int choose_arcs(bool use[ARCS], const struct step step[ARCS], const struct ring *ring,
                       const struct grey *tint, const struct rim_conf *conf)
{
	bool good[ARCS];
	double jump[ARCS], white[ARCS];
	int n = 0;
	rim_tint(white, ring, tint, conf->absolute);
	for (int i = 0; i < ARCS; i++) {
		good[i] = step[i].ok && !step[i].steep && ring->inside[i] && step[i].rms < conf->max_rms && white[i] > RIM_WHITE;
		if (good[i])
			jump[n++] = step[i].out - step[i].in;
	}
	if (n < (conf->known ? 1 : MIN_ARCS))
		return 0;
	double typical = stats_median(n, jump), rms = MEDIAN(step, good, rms);
	for (int i = 0; i < ARCS; i++)
		good[i] = good[i] && step[i].out - step[i].in > conf->min_contrast * typical && step[i].rms < 4 * rms + 0.01;
	n = 0;
	for (int i = 0; i < ARCS; i++) {
		int near = 0;
		for (int j = -3; j <= 3; j++)
			near += good[(i + j + ARCS) % ARCS];
		use[i] = good[i] && near >= 5;
		n += use[i];
	}
	return n;
}

static bool refit(struct rim *rim, struct ellipse_fit *fit, const struct ring *ring, bool use[ARCS], const struct rim_conf *conf)
{
	double p[ARCS][2], weight[ARCS], tukey[ARCS];
	int at[ARCS], n = 0;
	double rms = MEDIAN(rim->step, use, rms), jump = MEDIAN(rim->step, use, out) - MEDIAN(rim->step, use, in);
	for (int i = 0; i < ARCS; i++) {
		for (int c = 0; c < 2; c++)
			rim->p[i][c] = ring->p[i][c] + rim->step[i].d * ring->normal[i][c];
		memcpy(rim->normal[i], ring->normal[i], sizeof rim->normal[i]);
		rim->t[i] = ring->t[i];
		if (!use[i])
			continue;
		memcpy(p[n], rim->p[i], sizeof p[n]);
		/* residuals of a step are texture, and correlated: they count for more than their number says */
		double trust = 1 + pow(rim->step[i].rms / rms, 2) + pow(0.3 * jump / (rim->step[i].out - rim->step[i].in), 2);
		weight[n] = 4 / (trust * trust);
		at[n++] = i;
	}
	struct ellipse e = ring->e;
	bool ok = conf->known ? ellipse_fit_near(&e, fit, n, p, weight, tukey, LEAST_NOISE, conf->known)
	                      : n >= MIN_ARCS && ellipse_fit_robust(&e, fit, n, p, weight, tukey, 0, true);
	if (!ok || e.b < 0.5 * e.a)
		return false;
	for (int i = 0; i < n; i++)
		use[at[i]] = tukey[i] > 0.2;
	rim->e = e;
	return true;
}

/* Arcs that err together: 1 + 2 sum of the residuals' autocorrelation along the ring, up to its first zero
 * (the variance of a mean grows by that factor). The covariance follows. */
static void correlate(struct rim *rim, const struct ellipse_fit *fit, double irregularity, double straying)
{
	double d[ARCS], sum[MAX_LAG] = { 0 }, ss = 0;
	int count[MAX_LAG] = { 0 }, n = 0;
	for (int i = 0; i < ARCS; i++) {
		double t;
		d[i] = rim->used[i] ? ellipse_distance(&t, &rim->e, rim->p[i]) : 0;
		ss += d[i] * d[i];
		n += rim->used[i];
	}
	for (int i = 0; i < ARCS; i++)
		for (int k = 0; k < MAX_LAG && rim->used[i]; k++)
			if (rim->used[(i + k) % ARCS]) {
				sum[k] += d[i] * d[(i + k) % ARCS];
				count[k]++;
			}
	rim->correlation = 1;
	memcpy(rim->cov_q, fit->known_q, sizeof rim->cov_q);
	if (!n)
		return;
	rim->rms = sqrt(ss / n);
	rim->share_used = (double)n / ARCS;
	for (int k = 1; k < MAX_LAG && count[k] > 0 && sum[k] > 0; k++)
		rim->correlation += 2 * (sum[k] / count[k]) / (sum[0] / count[0]);
	for (int a = 0; a < ELLIPSE_N; a++)
		for (int b = 0; b < ELLIPSE_N; b++)
			rim->cov_q[a][b] += rim->correlation * n / fmax(n - ELLIPSE_N, 1) * fit->cov_q[a][b];
	/* What strays smoothly along the ring strays more slowly, too, as no residual of an ellipse shows: about as far, were it 1 / f noise. */
	double smooth = 0;
	for (int k = SMOOTH_FROM; k <= SMOOTH_TO; k++)
		smooth += count[k] ? fmax(sum[k] / count[k], 0) / (SMOOTH_TO - SMOOTH_FROM + 1) : 0;
	/* what moves a whole side moves centre and size; the shape less */
	for (int a = 0; a < ELLIPSE_N; a++)
		rim->cov_q[a][a] += (pow(irregularity * rim->width, 2) + straying * smooth) * (a < 3 ? 1 : 0.16);
}

/* The ramp is foreshortened with the limbus and blurred by focus: its width varies slowly along the ring. */
static void smooth_widths(struct rim *rim, const bool use[ARCS])
{
	for (int i = 0; i < ARCS; i++) {
		double v[2 * WIDTH_ARCS + 1];
		int n = 0;

		for (int j = -WIDTH_ARCS; j <= WIDTH_ARCS; j++) {
			int at = (i + j + ARCS) % ARCS;
			if (use[at])
				v[n++] = rim->step[at].w;
		}
		double w = n >= WIDTH_ARCS / 2 ? stats_median(n, v) : rim->width;
		rim->widths[i] = fmin(fmax(w, 0.6 * rim->width), 1.35 * rim->width);
	}
}

/* One pass of the blurred step. free_width: each arc's own, for its median. */
static bool fine_pass(struct rim *rim, struct ellipse_fit *fit, const struct grey *grey, const struct grey *tint, double window,
                      bool free_width, int width, int height, const struct rim_conf *conf)
{
	const double lo = -2.4 * window, hi = 2.4 * window;
	struct ring r = ring_sample(grey, &rim->e, lo, hi, fmax(0.7 * grey->scale, window / 12), ACROSS,
	                            width, height);
	/* the first pass knows no step yet: no slopes */
	edge_slopes(rim->step, &r, fmin(2.3 * rim->width + 0.5, 1.15 * window));
#pragma omp parallel for schedule(static)
	for (int i = 0; i < ARCS; i++) {
		rim->step[i].d = 0;
		rim->step[i].w = rim->step[i].ok ? rim->widths[i] : rim->width;
		edge_fit(&rim->step[i], &r, i, window, free_width);
	}
	bool use[ARCS] = { 0 };
	bool ok = choose_arcs(use, rim->step, &r, tint, conf) >= (conf->known ? 0 : MIN_ARCS) && refit(rim, fit, &r, use, conf);
	bool any = false;
	for (int i = 0; i < ARCS; i++)
		any |= use[i];
	if (ok && free_width && any) {
		rim->width = MEDIAN(rim->step, use, w);
		smooth_widths(rim, use);
	}
	memcpy(rim->used, use, sizeof use);
	ring_free(&r);
	return ok;
}

/* Width of the blurred step from the typical profile of the arcs near the ellipse. */
static bool first_width(struct rim *rim, const struct grey *grey, const struct rim_conf *conf, int width, int height)
{
	const double reach = fmax(0.09 * rim->e.a, 8 * grey->scale);
	struct ring r = ring_sample(grey, &rim->e, -reach, reach, fmax(grey->scale, reach / 40), 3, width, height);
	bool use[ARCS];
	double shift[ARCS] = { 0 };
	int n = 0;
	for (int i = 0; i < ARCS; i++) {
		double at[EDGE_CANDIDATES], strength[EDGE_CANDIDATES];
		int found = edge_candidates(at, strength, &r, i, reach / 5);
		use[i] = false;
		for (int j = 0; j < found && r.inside[i]; j++)
			if (fabs(at[j]) < reach / 6) {
				use[i] = true;
				shift[i] = at[j];
				break;
			}
		n += use[i];
	}
	bool ok = n >= MIN_ARCS;
	rim->width = reach / 5;
	if (!ok && conf->known) {
		ring_free(&r);
		return true;
	}
	if (ok) {
		struct ring t = ring_typical(&r, use, shift);
		struct step f = { .w = reach / 5 };
		double window = reach / 2.4;
		for (int i = 0; i < 4 && ok; i++) {
			f.d = 0;
			edge_fit(&f, &t, 0, window, true);
			ok = f.ok;
			window = fmin(fmax(2.5 * f.w, 2.5 * r.step), reach / 2.4);
		}
		rim->width = f.w;
		ring_free(&t);
	}
	ring_free(&r);
	return ok;
}

/* Width of the step in every used arc by itself, the ellipse and the slopes being known. */
static void own_widths(struct rim *rim, const struct grey *grey, double window, int width, int height)
{
	struct ring r = ring_sample(grey, &rim->e, -2.4 * window, 2.4 * window, fmax(0.7 * grey->scale, window / 12), ACROSS,
	                            width, height);
#pragma omp parallel for schedule(static)
	for (int i = 0; i < ARCS; i++) {
		struct step f = rim->step[i];
		f.d = 0;
		f.w = rim->widths[i];
		edge_fit(&f, &r, i, window, true);
		rim->own_width[i] = rim->used[i] && f.ok ? f.w : 0;
	}
	ring_free(&r);
}

/* Rough ellipse to width of the step, in the given picture. */
static bool locate(struct rim *rim, const struct grey *grey, const struct grey *tint, const struct rim_conf *conf, int width,
                   int height)
{
	double range = conf->search * rim->e.a;
	for (int i = 0; i < 3; i++, range /= 2)
		if (!rim_consensus(&rim->e, grey, tint, fmax(range, 6 * grey->scale), conf->known, width, height)) {
			if (conf->known)
				break;
			return false;
		}
	return first_width(rim, grey, conf, width, height) || conf->known;
}

static double window_of(const struct rim *rim, const struct grey *grey, const struct rim_conf *conf)
{
	return fmin(fmax(1.9 * rim->width, 4 * grey->scale), fmax(0.07 * rim->e.a, conf->least_window));
}

bool rim_fit(struct rim *rim, const struct photo *photo, const struct grey *tint, const struct ellipse *start,
             const struct rim_conf *conf)
{
	*rim = (struct rim){ .e = *start };
	struct ellipse_fit fit = { 0 };
	double weight[3] = { 1 / 3.0, 1 / 3.0, 1 / 3.0 };
	double gain = conf->grey ? 0 : limbus_colour(weight, photo, start);
	const int w = photo->width, h = photo->height;
	struct grey grey = grey_linear(photo, start, 1.4, conf->max_axis, weight);
	bool ok = locate(rim, &grey, tint, conf, w, h);
	for (int i = 0; i < ARCS; i++)
		rim->widths[i] = rim->width;
	for (int i = 0; i < (rim->width < SHARP_PX || conf->passes < PASSES ? conf->passes - 1 : conf->passes) && ok; i++) {
		if (!conf->grey && (i == 0 || (i == 3 && rim->width >= SHARP_PX))) {
			/* JPEG keeps colour at half resolution: sharp steps are measured in brightness alone, where that shows them. Of soft
			 * ones the colours are looked at again, now that it is known better where they are. */
			if (rim->width >= SHARP_PX || gain > 1)
				gain = limbus_colour(weight, photo, &rim->e);
			for (int c = 0; c < 3 && rim->width < SHARP_PX && !(gain > (conf->passes < PASSES ? conf->rough_gain : conf->colour_gain)); c++)
				weight[c] = 1 / 3.0;
			grey_free(&grey);
			grey = grey_linear(photo, &rim->e, 1.3, conf->max_axis, weight);
		}
		double window = window_of(rim, &grey, conf);
		ok = fine_pass(rim, &fit, &grey, tint, window, i == 1 || i == 2, w, h, conf);
	}
	if (ok) {
		own_widths(rim, &grey, window_of(rim, &grey, conf), w, h);
		correlate(rim, &fit, conf->irregularity, conf->straying);
		rim_cover(rim, &grey, tint, conf->absolute, w, h);
		rim->contrast = MEDIAN(rim->step, rim->used, contrast);
		rim->out = MEDIAN(rim->step, rim->used, out);
		rim->in = MEDIAN(rim->step, rim->used, in);
		if (!(rim->share_used > 0))  // the prior alone: no step to tell of
			rim->contrast = rim->out = rim->in = 0;
	}
	grey_free(&grey);
	return ok;
}
