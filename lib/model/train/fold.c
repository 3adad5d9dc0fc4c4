#include <cblas.h>
#include <lapacke.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "math/regress.h"
#include "math/rng.h"
#include "model/train/fold.h"

struct errors errors_new(int K)
{
	return (struct errors){ .K = K, .error = mem_new((size_t)(MOST_FOLDS * K) + 1, sizeof(double)) };
}

static const double SHOWN = 0.05;  // of an expression's strength: less is noise

double errors_normalised(const struct errors *e, int folds, int k, double *sigma)
{
	double sum = 0, none = 0, squares = 0, all = 0;
	int n = 0;
	for (int f = 0; f < folds; f++) {
		sum += e->error[f * e->K + k];
		none += e->none[f];
	}
	for (int f = 0; f < folds && none > 0; f++)
		if (e->none[f] > 0) {
			double one = sqrt((sum - e->error[f * e->K + k]) / fmax(none - e->none[f], 1e-300));
			all += one;
			squares += one * one;
			n++;
		}
	if (sigma)
		*sigma = n > 1 ? sqrt(fmax(0, squares - all * all / n) * (n - 1) / n) : NAN;
	return none > 0 ? sqrt(sum / none) : NAN;
}

double *train_regressors(const struct train *t, int p, int *q)
{
	const struct skin_model *m = t->model;
	int kl = m->n_lid_pc / 2;
	*q = p == TRAIN_SKIN ? m->n_lid_pc + m->n_au : EYE_INPUTS;
	double *x = mem_new((size_t)t->n_sample * (size_t)*q + 1, sizeof *x);
	for (long i = 0; i < t->n_sample; i++) {
		const double *g = t->g + t->sample[i] * m->n_inputs;
		double *to = x + i * *q;
		for (int k = 0; k < EYE_INPUTS && p != TRAIN_SKIN; k++)
			to[k] = isnan(g[EYE_INPUTS * p + k]) ? 0 : g[EYE_INPUTS * p + k];  // such frames have weight 0
		if (p != TRAIN_SKIN)
			continue;
		for (int e = 0; e < 2; e++)
			for (int c = 0; c < kl && t->part[e].used; c++)
				for (int a = 0; a < t->n_eye; a++)
					to[e * kl + c] += t->part[e].V_all[a * t->part[e].k_max + c]
					                  * (t->part[e].x[i * t->n_eye + a] - t->part[e].sum.mean[EYE_INPUTS + a]);
		memcpy(to + m->n_lid_pc, g + SKIN_EYE_INPUTS, (size_t)m->n_au * sizeof *to);
	}
	return x;
}

/* Radial basis functions measure distances: angles are divided by one common scale, apertures by another, lid components by that of
 * the largest. [m][q], free(). */
static double *comparable(const struct cv *cv, int p)
{
	double *x = mem_array((size_t)cv->m * (size_t)cv->q + 1, sizeof *x), *sd = mem_new((size_t)cv->q + 1, sizeof *sd);
	for (int c = 0; c < cv->q; c++) {
		double sum = 0, squares = 0, weight = 0;
		for (long i = 0; i < cv->m; i++) {
			double v = cv->x[i * cv->q + c];
			sum += cv->w[i] * v;
			squares += cv->w[i] * v * v;
			weight += cv->w[i];
		}
		sd[c] = weight > 0 ? sqrt(fmax(0, squares / weight - sum * sum / weight / weight)) : 0;
	}
	for (int c = 0; c < cv->q; c++) {
		int first = p != TRAIN_SKIN ? (c < 3 ? 0 : 3) : c < cv->t->model->n_lid_pc ? 0 : c;
		int last = p != TRAIN_SKIN ? (c < 3 ? 1 : 4) : c < cv->t->model->n_lid_pc ? cv->t->model->n_lid_pc - 1 : c;
		double scale = 0;
		for (int k = first; k <= last; k++)
			scale = fmax(scale, sd[k]);
		for (long i = 0; i < cv->m; i++)
			x[i * cv->q + c] = scale > 0 ? cv->x[i * cv->q + c] / scale : 0;
	}
	free(sd);
	return x;
}

void cv_shuffle(struct cv *cv)
{
	struct rng rng = { 7 };
	for (long i = 0; i < cv->m; i++)
		cv->fold[i] = rng_below(&rng, cv->folds);
}

/* A model cannot predict an expression that its training frames do not show: frames with more than twice the strength that the other
 * folds show are not held out. */
static void leave_unshown(struct cv *cv, int n_au)
{
	double *most = mem_array((size_t)cv->folds, sizeof *most);
	for (int a = cv->q - n_au; a < cv->q; a++) {
		for (int f = 0; f < cv->folds; f++)
			most[f] = 0;
		for (long i = 0; i < cv->m; i++)
			for (int f = 0; f < cv->folds && cv->fold[i] >= 0; f++)
				if (cv->fold[i] != f)
					most[f] = fmax(most[f], fabs(cv->x[i * cv->q + a]));
		for (long i = 0; i < cv->m; i++)
			if (cv->fold[i] >= 0 && fabs(cv->x[i * cv->q + a]) > fmax(SHOWN, 2 * most[cv->fold[i]]))
				cv->fold[i] = -1;
	}
	free(most);
}

struct cv cv_new(const struct train *t, int p)
{
	const struct part *part = &t->part[p];
	struct cv cv = { .t = t, .part = part, .m = t->n_sample, .R = part->k_max, .w = part->w };
	int n = part->n;
	cv.x = train_regressors(t, p, &cv.q);
	cv.s = mem_new((size_t)cv.m * (size_t)cv.R + 1, sizeof *cv.s);
	cv.rest = mem_new((size_t)cv.m + 1, sizeof *cv.rest);
	cv.fold = mem_new((size_t)cv.m + 1, sizeof *cv.fold);
	double *y = mem_array((size_t)cv.m * (size_t)n + 1, sizeof *y);
	for (long i = 0; i < cv.m; i++)
		for (int c = 0; c < n; c++) {
			y[i * n + c] = part->x[i * n + c] - part->sum.mean[part->from + c];
			cv.rest[i] += y[i * n + c] * y[i * n + c];
		}
	cblas_dgemm(CblasRowMajor, CblasNoTrans, CblasNoTrans, (int)cv.m, cv.R, n, 1, y, n, part->V_all, cv.R, 0, cv.s, cv.R);
	free(y);
	cv.folds = t->conf->folds < MOST_FOLDS ? t->conf->folds : MOST_FOLDS;
	for (long i = 0; i < cv.m; i++) {
		for (int c = 0; c < cv.R; c++)
			cv.rest[i] -= cv.s[i * cv.R + c] * cv.s[i * cv.R + c];
		cv.rest[i] = fmax(cv.rest[i], 0);
		cv.fold[i] = t->block[i] < 0 ? -1 : t->block[i] % cv.folds;
	}
	if (p == TRAIN_SKIN)
		leave_unshown(&cv, t->model->n_au);
	cv.scaled = comparable(&cv, p);
	return cv;
}

void cv_free(struct cv *cv)
{
	free(cv->x);
	free(cv->s);
	free(cv->scaled);
	free(cv->rest);
	free(cv->fold);
}

double *cv_weights(const struct cv *cv, int f, bool test)
{
	double *w = mem_new((size_t)cv->m + 1, sizeof *w);
	for (long i = 0; i < cv->m; i++)
		w[i] = cv->fold[i] >= 0 && (cv->fold[i] == f) == test ? cv->w[i] : 0;
	return w;
}

void cv_components(const struct cv *cv, const double *w, double *mean, double *V)
{
	int R = cv->R;
	double *G = mem_new((size_t)(R * R) + 1, sizeof *G), *same = mem_new((size_t)(R * R) + 1, sizeof *same);
	double *d = mem_new((size_t)R + 1, sizeof *d), *again = mem_new((size_t)R + 1, sizeof *again);
	regress_moments(G, same, mean, again, cv->m, R, R, cv->s, cv->s, w);
	LAPACKE_dsyevd(LAPACK_ROW_MAJOR, 'V', 'L', R, G, R, d);
	for (int i = 0; i < R; i++)
		for (int c = 0; c < R; c++)
			V[i * R + c] = d[R - 1 - c] > train_rounding(R, d[R - 1]) ? G[i * R + R - 1 - c] : 0;
	free(G);
	free(same);
	free(d);
	free(again);
}

void cv_add_errors(struct errors *e, const struct cv *cv, int f, const double *y, const double *mean, const double *V)
{
	int R = cv->R, K = e->K;
	double *a = mem_new((size_t)(2 * K) + 1, sizeof *a), *b = a + K;
	e->none[f] = 0;
	for (long i = 0; i < cv->m; i++) {
		if (cv->fold[i] != f || !(cv->w[i] > 0))
			continue;
		double all = cv->rest[i];
		memset(a, 0, (size_t)(2 * K) * sizeof *a);
		for (int k = 0; k < R; k++) {
			double own = cv->s[i * R + k] - mean[k], to = y ? y[i * R + k] - mean[k] : own;
			all += own * own;
			for (int c = 0; c < K; c++) {
				a[c] += V[k * R + c] * own;
				b[c] += V[k * R + c] * to;
			}
		}
		e->none[f] += cv->w[i] * all;
		for (int k = 0; k < K; k++) {
			all += (a[k] - b[k]) * (a[k] - b[k]) - a[k] * a[k];
			e->error[f * K + k] += cv->w[i] * fmax(all, 0);
		}
	}
	free(a);
}
