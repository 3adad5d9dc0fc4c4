/* A part: fills in its frames from the pilot and weighs them. */
#include <cblas.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "math/chol.h"
#include "model/train/impl.h"

enum { CHUNK = 64 };

void part_free(struct part *p)
{
	scatter_free(&p->sum);
	free(p->seen);
	free(p->mean);
	free(p->V);
	free(p->variance);
	free(p->x);
	free(p->w);
	free(p->V_all);
	free(p->sd_all);
	*p = (struct part){ 0 };
}

static bool is_missing(const struct part *p, int i, double c)
{
	return p->seen[i] && !(c > 0);
}

/* Scores of one frame with missing numbers: the most probable ones under the pilot's normal distribution (probabilistic principal
 * components, Tipping and Bishop 1999), s = (V'V + noise^2 / variance)^-1 V'y over the numbers measured. s[k]: V'y in, s out. */
static void solve_scores(double *s, const struct part *p, const double *c)
{
	double A[PILOT_COMPONENTS][PILOT_COMPONENTS] = { 0 };
	int k = p->k;
	for (int a = 0; a < k; a++)
		A[a][a] = 1 + p->usual * p->usual / fmax(p->variance[a], 1e-12 * p->variance[0] + 1e-300);
	for (int i = 0; i < p->n; i++) {
		if (!is_missing(p, i, c[i]))
			continue;
		const double *v = p->V + i * k;
		for (int a = 0; a < k; a++)
			for (int b = 0; b <= a; b++)
				A[a][b] -= v[a] * v[b];
	}
	chol_solve(k, PILOT_COMPONENTS, A[0], s);
}

/* fit[m][n], out: each frame projected onto the pilot, from its measured numbers. */
static void fit_rows(double *fit, const struct part *p, int m, const double *x, const double *c)
{
	int n = p->n, k = p->k;
	double *scores = mem_new((size_t)(m * k) + 1, sizeof *scores);
	bool *missing = mem_new((size_t)m + 1, sizeof *missing);
	for (int r = 0; r < m; r++)
		for (int i = 0; i < n; i++) {
			bool gone = is_missing(p, i, c[r * n + i]);
			missing[r] |= gone;
			fit[r * n + i] = gone || !p->seen[i] ? 0 : x[r * n + i] - p->mean[i];
		}
	if (k) {
		cblas_dgemm(CblasRowMajor, CblasNoTrans, CblasNoTrans, m, k, n, 1, fit, n, p->V, k, 0, scores, k);
		for (int r = 0; r < m; r++)
			if (missing[r])
				solve_scores(scores + r * k, p, c + r * n);
		cblas_dgemm(CblasRowMajor, CblasNoTrans, CblasTrans, m, n, k, 1, scores, k, p->V, k, 0, fit, n);
	} else
		memset(fit, 0, (size_t)m * (size_t)n * sizeof *fit);
	for (int r = 0; r < m; r++)
		for (int i = 0; i < n; i++)
			fit[r * n + i] += p->mean[i];
	free(scores);
	free(missing);
}

/* Weighted root mean square distance d of a frame's measured numbers from its fit; share of its numbers measured. */
static void distance(double *d, double *share, const struct part *p, const double *x, const double *fit, const double *c)
{
	double sum = 0, weight = 0, seen = 0, all = 0;
	for (int i = 0; i < p->n; i++) {
		if (!p->seen[i])
			continue;
		all++;
		if (!(c[i] > 0))
			continue;
		sum += c[i] * (x[i] - fit[i]) * (x[i] - fit[i]);
		weight += c[i];
		seen++;
	}
	*d = weight > 0 ? sqrt(sum / weight) : 0;
	*share = all > 0 ? seen / all : 0;
}

bool part_all_measured(const struct part *p, int m, const double *c)
{
	for (int r = 0; r < m; r++)
		for (int i = 0; i < p->n; i++)
			if (p->seen[i] && !(c[r * p->n + i] >= 1))
				return false;
	return true;
}

/* The same for frames without missing numbers, faster: the squared distance is the squared length less that of the scores. */
static void measure_chunk(const struct part *p, int m, double *x, double *d, double *share)
{
	int n = p->n, k = p->k, seen = 0;
	double *y = mem_array((size_t)(m * n) + 1, sizeof *y), *scores = mem_new((size_t)(m * k) + 1, sizeof *scores);
	for (int i = 0; i < n; i++)
		seen += p->seen[i];
	for (int r = 0; r < m; r++) {
		double *xr = x + r * n, *yr = y + r * n, squares = 0;
#pragma omp simd reduction(+ : squares)
		for (int i = 0; i < n; i++) {
			double to = p->seen[i] ? xr[i] : p->mean[i], one = to - p->mean[i];
			xr[i] = to;
			yr[i] = one;
			squares += one * one;
		}
		d[r] = squares;
	}
	if (k)
		cblas_dgemm(CblasRowMajor, CblasNoTrans, CblasNoTrans, m, k, n, 1, y, n, p->V, k, 0, scores, k);
	for (int r = 0; r < m; r++) {
		for (int a = 0; a < k; a++)
			d[r] -= scores[r * k + a] * scores[r * k + a];
		d[r] = seen ? sqrt(fmax(d[r], 0) / seen) : 0;
		share[r] = seen > 0;
	}
	free(y);
	free(scores);
}

void part_complete_few(const struct part *p, int m, double *x, const double *c, double *d, double *share)
{
	int n = p->n;
	if (part_all_measured(p, m, c)) {
		measure_chunk(p, m, x, d, share);
		return;
	}
	double *fit = mem_array((size_t)(m * n) + 1, sizeof *fit);
	fit_rows(fit, p, m, x, c);
	for (int r = 0; r < m; r++) {
		distance(&d[r], &share[r], p, x + r * n, fit + r * n, c + r * n);
		for (int i = 0; i < n; i++) {
			double believed = p->seen[i] && c[r * n + i] > 0 ? c[r * n + i] : 0, *to = &x[r * n + i];
			if (believed < 1)
				*to = believed > 0 ? believed * *to + (1 - believed) * fit[r * n + i] : fit[r * n + i];
		}
	}
	free(fit);
}

void part_complete(struct part *p, long n, double *x, const double *c, double *d, double *share)
{
#pragma omp parallel for schedule(dynamic)
	for (long at = 0; at < n; at += CHUNK) {
		int m = n - at < CHUNK ? (int)(n - at) : CHUNK;
		size_t o = (size_t)at * (size_t)p->n;
		part_complete_few(p, m, x + o, c + o, d + at, share + at);
	}
}

double part_weight(const struct part *p, const struct train_conf *conf, double d)
{
	double ratio = p->usual > 0 ? d / p->usual : 0;
	return ratio <= conf->huber ? 1 : ratio > conf->trim ? 0 : conf->huber * conf->huber / ratio / ratio;
}
