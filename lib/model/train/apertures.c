/* Apertures: what closed and open are (equations 3.6 and 3.7), and the baseline over gaze (equation 3.11). */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "math/regress.h"
#include "math/stats.h"
#include "model/train/impl.h"

enum { BASELINE_STEPS = 20 };

static bool is_aperture(int input)
{
	return input < SKIN_EYE_INPUTS && input % EYE_INPUTS >= 3;
}

struct closure {
	double iota;
	long frame;
};

static int by_iota(const void *a, const void *b)
{
	const struct closure *x = a, *y = b;
	return x->iota != y->iota ? (x->iota > y->iota) - (x->iota < y->iota) : (x->frame > y->frame) - (x->frame < y->frame);
}

/* Openness iota (equation 3.6, as corrected in tests/ERRATA.md) of the frames in which the apertures of all modelled eyes are measured,
 * sorted from closed to open. Returns how many. */
static long closures(struct closure *out, const struct train *t)
{
	long n = 0;
	int stride = t->model->n_inputs;
	for (long i = 0; i < t->clip->n; i++) {
		const double *g = t->clip->g + i * stride;
		double iota = 0;
		for (int e = 0; e < 2; e++)
			iota += t->eye[e] ? fabs(g[5 * e + 3] + g[5 * e + 4]) : 0;
		if (!isnan(iota))
			out[n++] = (struct closure){ iota, i };
	}
	qsort(out, (size_t)n, sizeof *out, by_iota);
	return n;
}

/* Mean of every aperture over n frames; *sigma: standard deviation of one frame, pooled over the apertures. */
static void mean_apertures(double out[SKIN_EYE_INPUTS], double *sigma, const struct train *t, long n,
                           const struct closure *of)
{
	double squares = 0, count = 0;
	for (int i = 0; i < SKIN_EYE_INPUTS; i++) {
		out[i] = 0;
		if (!is_aperture(i) || !t->eye[i / EYE_INPUTS])
			continue;
		for (long k = 0; k < n; k++)
			out[i] += t->clip->g[of[k].frame * t->model->n_inputs + i] / (double)n;
		for (long k = 0; k < n; k++)
			squares += pow(t->clip->g[of[k].frame * t->model->n_inputs + i] - out[i], 2);
		count += (double)n - 1;
	}
	*sigma = count > 0 ? sqrt(squares / count) : NAN;
}

/* Frames in which gaze alone opens the eye, of one lid. */
struct calm {
	long n;
	double *x, *y;  // [n][2] g1 g2, [n] control
	int *block;     // [n] of time
	double *w, *r;
};

/* Slopes and constant a of y over x by iteratively reweighted least squares with Huber weights (1.345 sigma), without one block (-1:
 * all). An eye that did not move gets a constant. */
static void baseline_fit(double a[3], struct calm *c, int without)
{
	double Gxx[4], Gxy[2], mx[2], my;
	for (long i = 0; i < c->n; i++)
		c->w[i] = c->block[i] != without;
	for (int step = 0; step < BASELINE_STEPS; step++) {
		double weight = regress_moments(Gxx, Gxy, mx, &my, c->n, 2, 1, c->x, c->y, c->w);
		regress(a, 2, 1, Gxx, Gxy, weight, mx, 0);
		a[2] = my - a[0] * mx[0] - a[1] * mx[1];
		for (long i = 0; i < c->n; i++) {
			c->r[i] = fabs(c->y[i] - a[0] * c->x[2 * i] - a[1] * c->x[2 * i + 1] - a[2]);
			c->w[i] = c->r[i];
		}
		double limit = 1.345 * 1.4826 * stats_median((int)c->n, c->w);
		for (long i = 0; i < c->n; i++)
			c->w[i] = c->block[i] == without ? 0 : c->r[i] <= limit ? 1 : limit / c->r[i];
	}
}

/* The same with standard errors, by the jackknife over blocks of time. */
static void baseline_with_sigma(double a[3], double sigma[3], struct calm *c, int blocks)
{
	double sum[3] = { 0 }, squares[3] = { 0 };
	int k = 0;
	for (int b = 0; b < blocks; b++, k++) {
		baseline_fit(a, c, b);
		for (int p = 0; p < 3; p++) {
			sum[p] += a[p];
			squares[p] += a[p] * a[p];
		}
	}
	for (int p = 0; p < 3; p++)
		sigma[p] = k > 1 ? sqrt(fmax(0, squares[p] - sum[p] * sum[p] / k) * (k - 1) / k) : NAN;
	baseline_fit(a, c, -1);
}

/* Whether gaze alone opens the eye in that frame: no blink, no expression. usual: median opening, px. */
static bool is_calm(const struct train *t, const double *g, int eye, double usual)
{
	bool calm = g[5 * eye + 3] + g[5 * eye + 4] > 0.6 * usual && !isnan(g[5 * eye] + g[5 * eye + 1]);
	for (int a = SKIN_EYE_INPUTS; a < t->model->n_inputs; a++)
		calm = calm && !(g[a] > TRAIN_ON);
	return calm;
}

double train_usual_opening(const struct train *t, int eye)
{
	double *sum = mem_array((size_t)t->clip->n + 1, sizeof *sum);
	long n = 0;
	for (long i = 0; i < t->clip->n; i++) {
		const double *g = t->clip->g + i * t->model->n_inputs + 5 * eye;
		if (!isnan(g[3] + g[4]))
			sum[n++] = g[3] + g[4];
	}
	double usual = stats_median((int)n, sum);
	free(sum);
	return usual;
}

/* Fits equation 3.11 to calm frames, at most as many as a sample has, spread evenly. */
static void baseline(struct train *t, int eye)
{
	struct skin_model *m = t->model;
	const struct train_clip *clip = t->clip;
	long step = 1 + clip->n / (t->conf->sample + 1);
	size_t room = (size_t)(clip->n / step + 2);
	struct calm c = { 0, mem_array(2 * room, sizeof *c.x), mem_array(room, sizeof *c.y), mem_array(room, sizeof *c.block),
		              mem_array(room, sizeof *c.w), mem_array(room, sizeof *c.r) };
	double usual = train_usual_opening(t, eye), *controls = mem_new((size_t)m->n_inputs, sizeof *controls);
	double span = clip->time[clip->n - 1] - clip->time[0];
	int blocks = (int)fmin(20, fmax(2, span / t->conf->block_s));
	for (int lid = 0; lid < 2; lid++) {
		c.n = 0;
		for (long i = 0; i < clip->n; i += step) {
			const double *g = clip->g + i * m->n_inputs;
			if (!is_calm(t, g, eye, usual))
				continue;
			skin_model_controls(controls, m, g);
			memcpy(c.x + 2 * c.n, g + 5 * eye, 2 * sizeof *c.x);
			c.y[c.n] = controls[5 * eye + 3 + lid];
			c.block[c.n++] = (int)(i * blocks / clip->n);
		}
		if (c.n >= 4)
			baseline_with_sigma(m->baseline[eye][lid], m->baseline_sigma[eye][lid], &c, blocks);
	}
	free(c.x);
	free(c.y);
	free(c.block);
	free(c.w);
	free(c.r);
	free(controls);
}

/* A lid that moves with the gaze rather than with the opening stands at almost the same place in the closed and in the open eye, and
 * equation 3.7 would divide by almost 0. Its range then becomes that of 90 % of the clip. */
static void widen(struct train *t)
{
	struct skin_model *m = t->model;
	double *x = mem_array((size_t)t->clip->n + 1, sizeof *x);
	for (int i = 0; i < SKIN_EYE_INPUTS; i++) {
		int n = 0;
		for (long k = 0; k < t->clip->n && is_aperture(i) && t->eye[i / EYE_INPUTS]; k++)
			if (!isnan(t->clip->g[k * m->n_inputs + i]))
				x[n++] = t->clip->g[k * m->n_inputs + i];
		double range = n ? stats_quantile(n, x, 0.95) - stats_quantile(n, x, 0.05) : 0;
		if (n && m->open[i] - m->closed[i] < 0.5 * range)
			m->open[i] = m->closed[i] + range;
	}
	free(x);
}

void train_apertures(struct train *t)
{
	struct skin_model *m = t->model;
	struct closure *of = mem_array((size_t)t->clip->n + 1, sizeof *of);
	long n = closures(of, t), share = lround(t->conf->aperture_share * (double)n);
	double closed_sigma, open_sigma;
	share = share < 1 ? 1 : share;
	if (n) {
		mean_apertures(m->closed, &closed_sigma, t, share, of);
		mean_apertures(m->open, &open_sigma, t, share, of + n - share);
		m->aperture_sigma = fmax(closed_sigma, open_sigma) / sqrt((double)share);
		double least = of[share / 2].iota, most = of[n - 1 - share / 2].iota;
		if (least > 0.35 * most) {
			t->report->never_closed = true;
			memset(m->closed, 0, sizeof m->closed);
			train_warn(t, "%s: the lids never close (openness %.0f to %.0f px): closed is taken as the closed lids' plane; film a blink",
			           t->clip->place, least, most);
		}
	}
	widen(t);
	for (int e = 0; e < 2; e++)
		if (t->eye[e] && n)
			baseline(t, e);
	free(of);
}
