/* Cross-validation over blocks of time, on the sample: the ridge, figure 3.7's curves, the networks to compare with. */
#include <cblas.h>
#include <lapacke.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "math/rbf.h"
#include "math/regress.h"
#include "math/rng.h"
#include "skin/train_impl.h"

static const double ridges[] = { 0, 1e-5, 1e-4, 1e-3, 1e-2, 1e-1, 1 };
static const int functions[] = { 10, 20, 40, 80 };
static const double widths[] = { 1, 2, 4, 8 }, rbf_ridges[] = { 1e-7, 1e-5, 1e-3 };
enum { MOST_FOLDS = 20, RBFS = COUNT(functions) * COUNT(widths) * COUNT(rbf_ridges) };

/* One part of the sample in the coordinates of its own components. */
struct cv {
	const struct train *t;
	const struct part *part;
	long m;
	int q, R;          // regressors, components
	double *x, *s;     // [m][q] regressors; [m][R] scores
	double *scaled;    // [m][q] regressors of comparable scale, for the networks
	double *rest;      // [m] squared length outside the components, px^2
	const double *w;   // [m]
	int *fold;         // [m]; -1: in a gap
	int folds;
};

/* Held-out squared errors of one method for 1..K components, and those of the mean, for each fold. */
struct errors {
	int K;
	double *error;  // [MOST_FOLDS][K]
	double none[MOST_FOLDS];
};

static struct errors errors_new(int K)
{
	return (struct errors){ .K = K, .error = mem_new((size_t)(MOST_FOLDS * K) + 1, sizeof(double)) };
}

/* Normalised error at k components; *sigma (may be null): its standard error over the folds. */
static double normalised(const struct errors *e, int folds, int k, double *sigma)
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
			to[k] = isnan(g[EYE_INPUTS * p + k]) ? 0 : g[EYE_INPUTS * p + k];  // such frames weigh nothing
		if (p != TRAIN_SKIN)
			continue;
		for (int e = 0; e < 2; e++)
			for (int c = 0; c < kl && t->part[e].used; c++)
				for (int a = 0; a < t->n_eye; a++)
					to[e * kl + c] += m->K[(size_t)(e * t->n_eye + a) * (size_t)m->n_lid_pc + (size_t)(e * kl + c)]
					                  * (t->part[e].x[i * t->n_eye + a] - t->part[e].sum.mean[EYE_INPUTS + a]);
		memcpy(to + m->n_lid_pc, g + SKIN_EYE_INPUTS, (size_t)m->n_au * sizeof *to);
	}
	return x;
}

/* Gaussians see distances: angles share one scale, apertures another, lid components the largest one's. */
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

/* As in the paper: frames drawn at random, so that a frame's neighbours tell of it. */
static void shuffle_folds(struct cv *cv)
{
	struct rng rng = { 7 };
	for (long i = 0; i < cv->m; i++)
		cv->fold[i] = rng_below(&rng, cv->folds);
}

static struct cv cv_new(const struct train *t, int p)
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
	cv.scaled = comparable(&cv, p);
	return cv;
}

static void cv_free(struct cv *cv)
{
	free(cv->x);
	free(cv->s);
	free(cv->scaled);
	free(cv->rest);
	free(cv->fold);
}

/* Weights of the frames that fold f is trained on (test false) or tested with. */
static double *fold_weights(const struct cv *cv, int f, bool test)
{
	double *w = mem_new((size_t)cv->m + 1, sizeof *w);
	for (long i = 0; i < cv->m; i++)
		w[i] = cv->fold[i] >= 0 && (cv->fold[i] == f) == test ? cv->w[i] : 0;
	return w;
}

/* Components of the training frames of a fold, within those of the clip: mean[R], V[R][R], largest first. */
static void fold_components(const struct cv *cv, const double *w, double *mean, double *V)
{
	int R = cv->R;
	double *G = mem_new((size_t)(R * R) + 1, sizeof *G), *same = mem_new((size_t)(R * R) + 1, sizeof *same);
	double *d = mem_new((size_t)R + 1, sizeof *d), *again = mem_new((size_t)R + 1, sizeof *again);
	regress_moments(G, same, mean, again, cv->m, R, R, cv->s, cv->s, w);
	LAPACKE_dsyevd(LAPACK_ROW_MAJOR, 'V', 'L', R, G, R, d);
	for (int i = 0; i < R; i++)
		for (int c = 0; c < R; c++)
			V[i * R + c] = G[i * R + R - 1 - c];
	free(G);
	free(same);
	free(d);
	free(again);
}

/* Adds fold f's held-out errors of predicted scores y[m][R] (null: the shapes' own, for the components alone). */
static void add_errors(struct errors *e, const struct cv *cv, int f, const double *y, const double *mean, const double *V)
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

static double *predict_linear(const struct cv *cv, const double *w, double ridge)
{
	int q = cv->q, R = cv->R;
	double *Gxx = mem_new((size_t)(q * q) + 1, sizeof *Gxx), *Gxy = mem_new((size_t)(q * R) + 1, sizeof *Gxy);
	double *mx = mem_new((size_t)q + 1, sizeof *mx), *my = mem_new((size_t)R + 1, sizeof *my);
	double *b = mem_new((size_t)(q * R) + 1, sizeof *b), *y = mem_array((size_t)cv->m * (size_t)R + 1, sizeof *y);
	double weight = regress_moments(Gxx, Gxy, mx, my, cv->m, q, R, cv->x, cv->s, w);
	regress(b, q, R, Gxx, Gxy, weight, mx, ridge);
	for (long i = 0; i < cv->m; i++)
		for (int c = 0; c < R; c++) {
			double sum = my[c];
			for (int k = 0; k < q; k++)
				sum += b[c * q + k] * (cv->x[i * q + k] - mx[k]);
			y[i * R + c] = sum;
		}
	free(Gxx);
	free(Gxy);
	free(mx);
	free(my);
	free(b);
	return y;
}

/* All ridges and the components alone; fold by fold. */
static void linear_errors(struct errors of[COUNT(ridges)], struct errors *pca, const struct cv *cv)
{
	int R = cv->R;
#pragma omp parallel for schedule(dynamic)
	for (int f = 0; f < cv->folds; f++) {
		double *w = fold_weights(cv, f, false), *mean = mem_new((size_t)R + 1, sizeof *mean);
		double *V = mem_new((size_t)(R * R) + 1, sizeof *V);
		fold_components(cv, w, mean, V);
		add_errors(pca, cv, f, 0, mean, V);
		for (int r = 0; r < COUNT(ridges); r++) {
			double *y = predict_linear(cv, w, ridges[r]);
			add_errors(&of[r], cv, f, y, mean, V);
			free(y);
		}
		free(w);
		free(mean);
		free(V);
	}
}

/* Rows of y that fold f is tested with. */
static void predict_fold(double *y, const struct rbf *rbf, const struct cv *cv, int f)
{
	for (long i = 0, n; i < cv->m; i += n) {
		for (n = 1; i + n < cv->m && cv->fold[i + n] == cv->fold[i];)
			n++;
		if (cv->fold[i] == f)
			rbf_predict(y + i * cv->R, rbf, n, cv->scaled + i * cv->q);
	}
}

static void random_errors(struct errors *e, const struct cv *cv, double ridge)
{
	double *mean = mem_new((size_t)cv->R + 1, sizeof *mean), *V = mem_new((size_t)(cv->R * cv->R) + 1, sizeof *V);
	for (int f = 0; f < cv->folds; f++) {
		double *w = fold_weights(cv, f, false), *y = predict_linear(cv, w, ridge);
		fold_components(cv, w, mean, V);
		add_errors(e, cv, f, y, mean, V);
		free(w);
		free(y);
	}
	free(mean);
	free(V);
}

static void rbf_errors(struct errors of[RBFS], const struct cv *cv)
{
	int R = cv->R, nw = COUNT(widths), nr = COUNT(rbf_ridges);
#pragma omp parallel for schedule(dynamic)
	for (int job = 0; job < cv->folds * COUNT(functions); job++) {
		int f = job / COUNT(functions), h = COUNT(functions) - 1 - job % COUNT(functions);
		double *w = fold_weights(cv, f, false), *mean = mem_new((size_t)R + 1, sizeof *mean);
		double *V = mem_new((size_t)(R * R) + 1, sizeof *V), *y = mem_array((size_t)cv->m * (size_t)R + 1, sizeof *y);
		struct rbf rbf;
		fold_components(cv, w, mean, V);
		rbf_centers(&rbf, functions[h], cv->m, cv->q, cv->scaled, w, 1);
		for (int k = 0; k < nw * nr; k++) {
			rbf_train(&rbf, widths[k / nr], rbf_ridges[k % nr], cv->m, R, cv->scaled, cv->s, w);
			predict_fold(y, &rbf, cv, f);
			add_errors(&of[h * nw * nr + k], cv, f, y, mean, V);
		}
		rbf_free(&rbf);
		free(w);
		free(mean);
		free(V);
		free(y);
	}
}

/* The one of n with the least error at the components kept; a later one must be better by half a per cent. */
static int best_of(int n, const struct errors of[], int folds, int k)
{
	int best = 0;
	for (int i = 1; i < n; i++)
		if (normalised(&of[i], folds, k, 0) < 0.995 * normalised(&of[best], folds, k, 0))
			best = i;
	return best;
}

static void curve_of(double *out, double *sigma, const struct errors *e, int folds)
{
	for (int k = 0; k < e->K; k++)
		out[k] = normalised(e, folds, k, sigma ? &sigma[k] : 0);
}

static void validate_part(struct train *t, int p)
{
	struct cv cv = cv_new(t, p);
	struct train_curve *curve = &t->report->curve[p];
	int most = t->part[p].kept;
	int K = (int)fmin(cv.R, fmax(t->conf->curve_components, most)), kept = (most < K ? most : K) - 1;
	struct errors linear[COUNT(ridges)], pca = errors_new(K), *rbf = mem_new(RBFS, sizeof *rbf);
	for (int i = 0; i < COUNT(ridges); i++)
		linear[i] = errors_new(K);
	for (int i = 0; i < RBFS; i++)
		rbf[i] = errors_new(K);
	*curve = (struct train_curve){ .n = K };
	double **const curves[] = { &curve->linear, &curve->rbf, &curve->pca, &curve->linear_sigma, &curve->rbf_sigma,
		                      &curve->random };
	for (int i = 0; i < COUNT(curves); i++)
		*curves[i] = mem_new((size_t)K + 1, sizeof(double));
	linear_errors(linear, &pca, &cv);
	int best = best_of(COUNT(ridges), linear, cv.folds, kept);
	curve->ridge = t->part[p].ridge = ridges[best];
	curve_of(curve->linear, curve->linear_sigma, &linear[best], cv.folds);
	curve_of(curve->pca, 0, &pca, cv.folds);
	double sum = 0, weight = 0;
	for (int f = 0; f < cv.folds; f++)
		sum += linear[best].error[f * K + kept];
	for (long i = 0; i < cv.m; i++)
		weight += cv.fold[i] >= 0 ? cv.w[i] : 0;
	curve->linear_px = weight > 0 ? sqrt(sum / weight / t->part[p].n) : NAN;
	if (!t->conf->brief) {
		rbf_errors(rbf, &cv);
		int b = best_of(RBFS, rbf, cv.folds, kept);
		curve_of(curve->rbf, curve->rbf_sigma, &rbf[b], cv.folds);
		curve->rbf_functions = functions[b / (COUNT(widths) * COUNT(rbf_ridges))];
		curve->rbf_width = widths[b / COUNT(rbf_ridges) % COUNT(widths)];
	}
	for (int i = 0; i < COUNT(ridges); i++)
		free(linear[i].error);
	for (int i = 0; i < RBFS; i++)
		free(rbf[i].error);
	free(pca.error);
	free(rbf);
	shuffle_folds(&cv);
	struct errors random = errors_new(K);
	random_errors(&random, &cv, curve->ridge);
	curve_of(curve->random, 0, &random, cv.folds);
	free(random.error);
	cv_free(&cv);
}

void train_validate(struct train *t, int p)
{
	validate_part(t, p);
}
