/* Cross-validation over blocks of time, on the sample: chooses the ridge, computes figure 3.7's curves, and trains the radial basis
 * functions to compare with. */
#include <math.h>
#include <stdlib.h>

#include "base/mem.h"
#include "math/rbf.h"
#include "math/regress.h"
#include "model/train/cv.h"

static const double ridges[] = { 0, 1e-5, 1e-4, 1e-3, 1e-2, 1e-1, 1 };
static const int functions[] = { 10, 20, 40, 80 };
static const double widths[] = { 1, 2, 4, 8 }, rbf_ridges[] = { 1e-7, 1e-5, 1e-3 };
enum { RBFS = COUNT(functions) * COUNT(widths) * COUNT(rbf_ridges) };

/* Scores y[m][R] of all frames, predicted by the linear model fitted with weights w. free(). */
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

/* Held-out errors with every ridge, and of the projection onto the components (pca), fold by fold. */
static void linear_errors(struct errors of[COUNT(ridges)], struct errors *pca, const struct cv *cv)
{
	int R = cv->R;
#pragma omp parallel for schedule(dynamic)
	for (int f = 0; f < cv->folds; f++) {
		double *w = cv_weights(cv, f, false), *mean = mem_new((size_t)R + 1, sizeof *mean);
		double *V = mem_new((size_t)(R * R) + 1, sizeof *V);
		cv_components(cv, w, mean, V);
		cv_add_errors(pca, cv, f, 0, mean, V);
		for (int r = 0; r < COUNT(ridges); r++) {
			double *y = predict_linear(cv, w, ridges[r]);
			cv_add_errors(&of[r], cv, f, y, mean, V);
			free(y);
		}
		free(w);
		free(mean);
		free(V);
	}
}

/* Predicts the rows of y that fold f is tested with; the others are left as they are. */
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
		double *w = cv_weights(cv, f, false), *y = predict_linear(cv, w, ridge);
		cv_components(cv, w, mean, V);
		cv_add_errors(e, cv, f, y, mean, V);
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
		double *w = cv_weights(cv, f, false), *mean = mem_new((size_t)R + 1, sizeof *mean);
		double *V = mem_new((size_t)(R * R) + 1, sizeof *V), *y = mem_array((size_t)cv->m * (size_t)R + 1, sizeof *y);
		struct rbf rbf;
		cv_components(cv, w, mean, V);
		rbf_centers(&rbf, functions[h], cv->m, cv->q, cv->scaled, w, 1);
		for (int k = 0; k < nw * nr; k++) {
			rbf_train(&rbf, widths[k / nr], rbf_ridges[k % nr], cv->m, R, cv->scaled, cv->s, w);
			predict_fold(y, &rbf, cv, f);
			cv_add_errors(&of[h * nw * nr + k], cv, f, y, mean, V);
		}
		rbf_free(&rbf);
		free(w);
		free(mean);
		free(V);
		free(y);
	}
}

/* Index of the method with the least error with k + 1 components; a later one must be better by half a per cent. */
static int best_of(int n, const struct errors of[], int folds, int k)
{
	int best = 0;
	for (int i = 1; i < n; i++)
		if (errors_normalised(&of[i], folds, k, 0) < 0.995 * errors_normalised(&of[best], folds, k, 0))
			best = i;
	return best;
}

static void curve_of(double *out, double *sigma, const struct errors *e, int folds)
{
	for (int k = 0; k < e->K; k++)
		out[k] = errors_normalised(e, folds, k, sigma ? &sigma[k] : 0);
}

/* Root mean square held-out error of one coordinate with kept + 1 components, px. */
static double held_out_px(const struct errors *e, const struct cv *cv, int kept)
{
	double sum = 0, weight = 0;
	for (int f = 0; f < cv->folds; f++)
		sum += e->error[f * e->K + kept];
	for (long i = 0; i < cv->m; i++)
		weight += cv->fold[i] >= 0 ? cv->w[i] : 0;
	return weight > 0 ? sqrt(sum / weight / cv->part->n) : NAN;
}

static double validate_linear(struct train_curve *curve, const struct cv *cv, int K, int kept)
{
	struct errors linear[COUNT(ridges)], pca = errors_new(K);
	for (int i = 0; i < COUNT(ridges); i++)
		linear[i] = errors_new(K);
	linear_errors(linear, &pca, cv);
	int best = best_of(COUNT(ridges), linear, cv->folds, kept);
	curve->ridge = ridges[best];
	curve_of(curve->linear, curve->linear_sigma, &linear[best], cv->folds);
	curve_of(curve->pca, 0, &pca, cv->folds);
	curve->linear_px = held_out_px(&linear[best], cv, kept);
	for (int i = 0; i < COUNT(ridges); i++)
		free(linear[i].error);
	free(pca.error);
	return curve->ridge;
}

static void validate_rbf(struct train_curve *curve, const struct cv *cv, int K, int kept)
{
	struct errors rbf[RBFS];
	for (int i = 0; i < RBFS; i++)
		rbf[i] = errors_new(K);
	rbf_errors(rbf, cv);
	int best = best_of(RBFS, rbf, cv->folds, kept);
	curve_of(curve->rbf, curve->rbf_sigma, &rbf[best], cv->folds);
	curve->rbf_functions = functions[best / (COUNT(widths) * COUNT(rbf_ridges))];
	curve->rbf_width = widths[best / COUNT(rbf_ridges) % COUNT(widths)];
	for (int i = 0; i < RBFS; i++)
		free(rbf[i].error);
}

void cv_least(double *least, const struct cv *cv, int K)
{
	struct errors of[COUNT(ridges)], pca = errors_new(K);
	for (int i = 0; i < COUNT(ridges); i++)
		of[i] = errors_new(K);
	linear_errors(of, &pca, cv);
	for (int k = 0; k < K; k++)
		least[k] = errors_normalised(&of[best_of(COUNT(ridges), of, cv->folds, k)], cv->folds, k, 0);
	for (int i = 0; i < COUNT(ridges); i++)
		free(of[i].error);
	free(pca.error);
}

void train_validate(struct train *t, int p)
{
	static const char *const parts[TRAIN_PARTS] = { "the left eye's lids", "the right eye's lids", "the skin" };
	struct cv cv = cv_new(t, p);
	struct train_curve *curve = &t->report->curve[p];
	int most = t->part[p].kept, K = (int)fmin(cv.R, fmax(t->conf->curve_components, most)), kept = (most < K ? most : K) - 1;
	*curve = (struct train_curve){ .n = K, .kept = kept + 1 };
	double **const curves[] = { &curve->linear, &curve->rbf, &curve->pca, &curve->linear_sigma, &curve->rbf_sigma,
		                        &curve->random };
	for (int i = 0; i < COUNT(curves); i++)
		*curves[i] = mem_new((size_t)K + 1, sizeof(double));
	t->part[p].ridge = validate_linear(curve, &cv, K, kept);
	if (isnan(curve->linear_px))
		train_warn(t, "%s: no frame could be held out: how well the model foretells it is not known: film longer", parts[p]);
	if (!t->conf->brief)
		validate_rbf(curve, &cv, K, kept);
	cv_shuffle(&cv);
	struct errors random = errors_new(K);
	random_errors(&random, &cv, curve->ridge);
	curve_of(curve->random, 0, &random, cv.folds);
	free(random.error);
	cv_free(&cv);
}
