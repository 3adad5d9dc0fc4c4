#include "math/scatter/impl.h"

#include <cblas.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"

enum { STRIPE = 64 };

void scatter_new(struct scatter *s, int p, int keep)
{
	*s = (struct scatter){ .p = p, .keep = keep };
	s->mean = mem_new((size_t)p + 1, sizeof *s->mean);
	if (keep > 0) {
		s->rows = mem_array((size_t)keep * (size_t)p + 1, sizeof *s->rows);
		s->weights = mem_array((size_t)keep + 1, sizeof *s->weights);
	} else
		s->S = mem_new((size_t)p * (size_t)p + 1, sizeof *s->S);
}

void scatter_free(struct scatter *s)
{
	free(s->mean);
	free(s->rows);
	free(s->weights);
	free(s->S);
	free(s->work);
	scatter_split_free(s);
	*s = (struct scatter){ 0 };
}

/* S += Y^T Y for the first `rows` rows of work, tile by tile of the lower triangle. */
static void add_square(struct scatter *s, int rows)
{
	int p = s->p, n = scatter_tiles(p);
	const double *y = s->work;
	if (s->split) {
		scatter_split_add(s, rows);
		return;
	}
#pragma omp parallel for schedule(dynamic)
	for (int t = 0; t < n; t++) {
		struct scatter_tile a = scatter_tile(p, t);
		double *to = s->S + (size_t)a.i0 * (size_t)p + a.j0;
		if (a.i0 == a.j0)
			cblas_dsyrk(CblasRowMajor, CblasLower, CblasTrans, a.ni, rows, 1, y + a.i0, p, 1, to, p);
		else
			cblas_dgemm(CblasRowMajor, CblasTrans, CblasNoTrans, a.ni, a.nj, rows, 1, y + a.i0, p, y + a.j0, p, 1, to, p);
	}
}

/* Computes the block's weighted mean, centres its rows on it and scales them by the roots of their weights. Columns are taken in
 * stripes, so that threads share nothing. */
static void centre_block(double *mean, struct scatter *s, int n, const double *w, double weight)
{
	int p = s->p;
	double *y = s->work;
#pragma omp parallel for
	for (int from = 0; from < p; from += STRIPE) {
		int to = from + STRIPE < p ? from + STRIPE : p;
		for (int r = 1; r < n; r++)  // relative to the first row: a constant column is exact
			for (int c = from; c < to; c++)
				mean[c] += w[r] / weight * (y[(size_t)r * (size_t)p + (size_t)c] - y[c]);
		for (int c = from; c < to; c++)
			mean[c] += y[c];
		for (int r = 0; r < n; r++) {
			double root = sqrt(w[r]), *row = y + (size_t)r * (size_t)p;
			for (int c = from; c < to; c++)
				row[c] = root * (row[c] - mean[c]);
		}
	}
}

/* Adds the block of n rows that is in s->work, weights w: centres it on its own mean, squares and merges it. */
static void merge_block(struct scatter *s, int n, const double *w)
{
	int p = s->p, used = 0;
	double weight = 0, *mean = mem_new((size_t)p + 1, sizeof *mean), *y = s->work;
	for (int r = 0; r < n; r++) {
		weight += w[r];
		used += w[r] > 0;
	}
	if (weight > 0) {
		centre_block(mean, s, n, w, weight);
		// The difference of the means is one more row (Chan, Golub and LeVeque).
		double share = weight / (s->weight + weight), root = sqrt(s->weight * share), *row = y + (size_t)n * (size_t)p;
		for (int c = 0; c < p; c++) {
			double d = mean[c] - s->mean[c];
			row[c] = root * d;
			s->mean[c] += share * d;
		}
		add_square(s, n + 1);
		s->weight += weight;
		s->n += used;
	}
	free(mean);
}

/* Turns the rows kept into the scatter matrix. */
static void square_rows(struct scatter *s)
{
	long n = s->n;
	int p = s->p;
	double *rows = s->rows, *w = s->weights;
	s->S = mem_new((size_t)p * (size_t)p + 1, sizeof *s->S);
	s->rows = s->weights = 0;
	s->n = 0;
	s->weight = 0;
	memset(s->mean, 0, (size_t)p * sizeof *s->mean);
	scatter_add(s, n, rows, w);
	free(rows);
	free(w);
}

static void keep_rows(struct scatter *s, long n, const double *x, const double *w)
{
	for (long r = 0; r < n; r++) {
		double one = w ? w[r] : 1;
		if (!(one > 0))
			continue;
		memcpy(s->rows + (size_t)s->n * (size_t)s->p, x + (size_t)r * (size_t)s->p, (size_t)s->p * sizeof *x);
		s->weights[s->n++] = one;
		s->weight += one;
		for (int c = 0; c < s->p; c++)
			s->mean[c] += one / s->weight * (x[(size_t)r * (size_t)s->p + (size_t)c] - s->mean[c]);
	}
}

void scatter_add(struct scatter *s, long n, const double *x, const double *w)
{
	if (!s->S && s->n + n <= s->keep) {
		keep_rows(s, n, x, w);
		return;
	}
	if (!s->S)
		square_rows(s);
	double one[SCATTER_BLOCK];
	scatter_rows(s);
	for (long at = 0; at < n; at += SCATTER_BLOCK) {
		int m = n - at < SCATTER_BLOCK ? (int)(n - at) : SCATTER_BLOCK;
		for (int r = 0; r < m; r++)
			one[r] = w ? w[at + r] : 1;
		memcpy(s->work, x + (size_t)at * (size_t)s->p, (size_t)m * (size_t)s->p * sizeof *x);
		merge_block(s, m, one);
	}
}

double *scatter_rows(struct scatter *s)
{
	if (!s->work)
		s->work = mem_array((size_t)(SCATTER_BLOCK + 1) * (size_t)s->p + 1, sizeof *s->work);
	return s->work;
}

void scatter_take(struct scatter *s, long n, const double *w)
{
	if (s->S) {
		merge_block(s, (int)n, w);
		return;
	}
	double *rows = s->work;  // adding may need it
	s->work = 0;
	scatter_add(s, n, rows, w);
	free(s->work);
	s->work = rows;
}

double *scatter_centred(const struct scatter *s, int from, int n)
{
	double *y = mem_array((size_t)s->n * (size_t)n + 1, sizeof *y);
	for (long r = 0; r < s->n; r++) {
		double root = sqrt(s->weights[r]);
		for (int c = 0; c < n; c++)
			y[r * n + c] = root * (s->rows[r * s->p + from + c] - s->mean[from + c]);
	}
	return y;
}

void scatter_cross(double *out, const struct scatter *s, int i0, int ni, int j0, int nj)
{
	if (s->S) {
		for (int i = 0; i < ni; i++)
			for (int j = 0; j < nj; j++) {
				size_t a = (size_t)(i0 + i), b = (size_t)(j0 + j), p = (size_t)s->p;
				out[i * nj + j] = a >= b ? s->S[a * p + b] : s->S[b * p + a];
			}
		return;
	}
	double *a = scatter_centred(s, i0, ni), *b = scatter_centred(s, j0, nj);
	cblas_dgemm(CblasRowMajor, CblasTrans, CblasNoTrans, ni, nj, (int)s->n, 1, a, ni, b, nj, 0, out, nj);
	free(a);
	free(b);
}

double scatter_energy(const struct scatter *s, int from, int n)
{
	double sum = 0;
	for (int c = from; s->S && c < from + n; c++)
		sum += s->S[(size_t)c * (size_t)s->p + (size_t)c];
	if (!s->S) {
		double *y = scatter_centred(s, from, n);
		for (long i = 0; i < s->n * n; i++)
			sum += y[i] * y[i];
		free(y);
	}
	return sum;
}
