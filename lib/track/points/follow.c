/* Measures one frame: every point by itself, then with its neighbours as a prior. */
#include <math.h>

#include "track/points/skin_track_impl.h"

/* Stretching of skin from frame to frame, and against its neighbours: standard deviations of the warp's matrix. */
static const double stretch_in_time = 0.1, stretch_in_space = 0.1;

static bool at_level(struct patch_warp *w, struct patch_fit *fit, const struct skin_track *t, int i, int level,
                     const struct patch_warp *expected, double at_sigma, double A_sigma)
{
	struct patch_prior prior = { *expected, at_sigma, A_sigma };
	return patch_align(w, fit, t->patches, i, level, &t->frame, &prior);
}

/* Keeps a result of higher correlation than the point's. */
static void keep(struct skin_warp *p, const struct patch_warp *w, double ncc, double sigma)
{
	if (ncc <= p->ncc)
		return;
	p->warp = *w;
	p->ncc = ncc;
	p->sigma = sigma;
}

/* Aligns the patch from `start`, coarse to fine from a level. */
static void try(struct skin_track *t, int i, int level, const struct patch_warp *start, const struct patch_warp *expected,
                double at_sigma, double A_sigma)
{
	struct patch_warp w = *start;
	struct patch_fit fit;
	for (int l = level; l > 0; l--)
		at_level(&w, &fit, t, i, l, expected, at_sigma, 0.5 * A_sigma);
	if (!at_level(&w, &fit, t, i, 0, expected, at_sigma, A_sigma))
		return;
	// fit.ncc is that before the last step: good enough where that step was small
	struct patch_fit look = fit;
	if (fit.step < 4 * t->conf.stop || patch_look(&look, t->patches, i, 0, &t->frame, &w))
		keep(&t->point[i], &w, look.ncc, fit.sigma);
}

/* From the frame before: on the finest level if that is enough, else from the coarsest. */
static void alone(struct skin_track *t, int i)
{
	struct skin_warp *p = &t->point[i];
	struct patch_warp start = p->before = p->warp;
	if (t->conf.quiet > 0 && p->seen) {
		p->changed += skin_track_changed(t, p->warp.at);
		if (p->changed < t->conf.quiet)
			return;
	}
	p->changed = 0;
	p->ncc = -1;
	p->seen = 0;
	try(t, i, 0, &start, &start, INFINITY, stretch_in_time);
	if (p->ncc < p->usual - 0.04 || p->ncc < t->conf.min_ncc)
		try(t, i, t->conf.levels - 1, &start, &start, INFINITY, stretch_in_time);
	p->seen = p->ncc >= t->conf.min_ncc;
	if (!p->seen)
		p->warp = start;
}

/* Restarts lost points and outliers from their neighbours' prediction; measures the others again with the prediction as a
 * prior, which resolves the aperture problem along lines and on plain skin. */
static void with_others(struct skin_track *t, int i)
{
	struct skin_warp *p = &t->point[i];
	const struct skin_field *f = &t->field[i];
	if (!f->n)
		return;
	double limit = t->conf.outlier + fmin(2 * f->spread, t->conf.outlier), sigma = hypot(t->conf.smooth, f->spread);
	double usual = p->usual, apart = hypot(p->warp.at[0] - f->warp.at[0], p->warp.at[1] - f->warp.at[1]);
	// a point that fits as usual and agrees with its neighbours is done
	if (p->seen && p->ncc > usual - 0.04 && apart < t->conf.agree)
		return;
	p->ncc = -1;
	if (p->seen && apart < limit)
		try(t, i, 0, &p->warp, &f->warp, sigma, stretch_in_space);
	if (p->ncc < usual - 0.04 || p->ncc < t->conf.min_ncc)
		try(t, i, 0, &f->warp, &f->warp, sigma, stretch_in_space);
	if (p->ncc < usual - 0.1)
		try(t, i, t->conf.levels > 2 ? 2 : t->conf.levels - 1, &f->warp, &f->warp, 2 * sigma, stretch_in_space);
	double off = hypot(p->warp.at[0] - f->warp.at[0], p->warp.at[1] - f->warp.at[1]);
	p->seen = p->ncc >= t->conf.min_ncc && off < limit;
	if (!p->seen) {
		p->warp = f->warp;
		p->ncc = fmax(p->ncc, 0);
	}
}

static void settle(struct skin_track *t, int i)
{
	struct skin_warp *p = &t->point[i];
	const struct skin_field *f = &t->field[i];
	for (int r = 0; r < 2; r++)
		p->best[r] = p->warp.at[r];
	double off = f->n ? hypot(p->warp.at[0] - f->warp.at[0], p->warp.at[1] - f->warp.at[1]) / (t->conf.outlier + fmin(2 * f->spread, t->conf.outlier)) : 0.5;
	p->confidence = p->seen ? fmin(1, (p->ncc - t->conf.min_ncc) / (1 - t->conf.min_ncc) * 1.5 + 0.05) * (1 - fmin(0.9, off * off)) : 0;
	// where neighbours disagree (lashes, folds that open and close) confidence falls
	double torn = f->n ? f->spread / t->conf.outlier : 0;
	p->confidence = torn > 2 ? 0 : p->confidence / (1 + torn * torn);
	if (p->seen)
		p->usual += 0.1 * (p->ncc - p->usual);
}

void skin_track_follow(struct skin_track *t)
{
	int n = t->points.n;
#pragma omp parallel for schedule(dynamic, 16)
	for (int i = 0; i < n; i++)
		alone(t, i);
	for (int s = 0; s < t->conf.sweeps; s++) {
		skin_track_ask(t);
#pragma omp parallel for schedule(dynamic, 16)
		for (int i = 0; i < n; i++)
			with_others(t, i);
	}
	if (t->conf.sweeps > 1)
		skin_track_ask(t);
#pragma omp parallel for schedule(static)
	for (int i = 0; i < n; i++)
		settle(t, i);
}
