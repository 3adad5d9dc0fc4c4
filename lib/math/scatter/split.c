#include <cblas.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "math/scatter/impl.h"

enum { ROWS = 64 };

/* Y = [E | U], U = T V^T + R with T = U V: U^T U = V (T^T T) V^T + V (T^T R) + (T^T R)^T V^T + R^T R, and
 * U^T E = V (T^T E) + R^T E. */
struct scatter_split {
	int from, n, k;   // columns of E; of U; directions
	double *V;        // [n][k]
	double *T, *TT, *TE, *TR;  // [SCATTER_BLOCK + 1][k]; [k][k], [k][from], [k][n] summed over all rows
	float *R;         // [SCATTER_BLOCK + 1][n]
	double *rest;     // [SCATTER_BLOCK + 1][n] R in double, for T^T R and R^T E
};

void scatter_split(struct scatter *s, int from, int k, const double *V)
{
	struct scatter_split *q = s->split = mem_new(1, sizeof *q);
	*q = (struct scatter_split){ .from = from, .n = s->p - from, .k = k };
	size_t n = (size_t)q->n, rows = SCATTER_BLOCK + 1;
	q->V = mem_array(n * (size_t)k + 1, sizeof *q->V);
	memcpy(q->V, V, n * (size_t)k * sizeof *V);
	q->T = mem_array(rows * (size_t)k + 1, sizeof *q->T);
	q->TT = mem_new((size_t)(k * k) + 1, sizeof *q->TT);
	q->TE = mem_new((size_t)k * (size_t)from + 1, sizeof *q->TE);
	q->TR = mem_new((size_t)k * n + 1, sizeof *q->TR);
	q->R = mem_array(rows * n + 1, sizeof *q->R);
	q->rest = mem_array(rows * n + 1, sizeof *q->rest);
}

void scatter_split_free(struct scatter *s)
{
	if (!s->split)
		return;
	free(s->split->V);
	free(s->split->T);
	free(s->split->TT);
	free(s->split->TE);
	free(s->split->TR);
	free(s->split->R);
	free(s->split->rest);
	free(s->split);
	s->split = 0;
}

/* Computes T and R of the block, ROWS rows at a time: as many as fit the core's cache. */
static void divide(struct scatter *s, int rows)
{
	struct scatter_split *q = s->split;
	int n = q->n, k = q->k, p = s->p;
#pragma omp parallel for schedule(dynamic)
	for (int at = 0; at < rows; at += ROWS) {
		int m = rows - at < ROWS ? rows - at : ROWS;
		const double *u = s->work + (size_t)at * (size_t)p + q->from;
		double *t = q->T + (size_t)at * (size_t)k, *r = q->rest + (size_t)at * (size_t)n;
		float *single = q->R + (size_t)at * (size_t)n;
		for (int i = 0; i < m; i++)
			memcpy(r + (size_t)i * (size_t)n, u + (size_t)i * (size_t)p, (size_t)n * sizeof *r);
		cblas_dgemm(CblasRowMajor, CblasNoTrans, CblasNoTrans, m, k, n, 1, r, n, q->V, k, 0, t, k);
		cblas_dgemm(CblasRowMajor, CblasNoTrans, CblasTrans, m, n, k, -1, t, k, q->V, k, 1, r, n);
		for (long i = 0; i < (long)m * n; i++)
			single[i] = (float)r[i];
	}
}

/* Adds the products whose size does not grow with n, in double: E^T E, T^T T, T^T E. */
static void add_known(struct scatter *s, int rows)
{
	struct scatter_split *q = s->split;
	int p = s->p, k = q->k, e = q->from;
	cblas_dgemm(CblasRowMajor, CblasTrans, CblasNoTrans, k, k, rows, 1, q->T, k, q->T, k, 1, q->TT, k);
	if (!e)
		return;
	cblas_dsyrk(CblasRowMajor, CblasLower, CblasTrans, e, rows, 1, s->work, p, 1, s->S, p);
	cblas_dgemm(CblasRowMajor, CblasTrans, CblasNoTrans, k, e, rows, 1, q->T, k, s->work, p, 1, q->TE, e);
}

/* Columns c..c+n-1 of R, in double: T^T R and R^T E. */
static void add_beside(struct scatter *s, int rows, int c, int n)
{
	struct scatter_split *q = s->split;
	int e = q->from, p = s->p;
	cblas_dgemm(CblasRowMajor, CblasTrans, CblasNoTrans, q->k, n, rows, 1, q->T, q->k, q->rest + c, q->n, 1, q->TR + c, q->n);
	if (e)
		cblas_dgemm(CblasRowMajor, CblasTrans, CblasNoTrans, n, e, rows, 1, q->rest + c, q->n, s->work, p, 1,
		            s->S + (size_t)(e + c) * (size_t)p, p);
}

/* One tile of the lower triangle of R^T R. */
static void add_rest(struct scatter *s, int rows, struct scatter_tile a, float *sum)
{
	struct scatter_split *q = s->split;
	int n = q->n;
	bool diagonal = a.i0 == a.j0;
	if (diagonal)
		cblas_ssyrk(CblasRowMajor, CblasLower, CblasTrans, a.ni, rows, 1, q->R + a.i0, n, 0, sum, SCATTER_TILE);
	else
		cblas_sgemm(CblasRowMajor, CblasTrans, CblasNoTrans, a.ni, a.nj, rows, 1, q->R + a.i0, n, q->R + a.j0, n, 0, sum, SCATTER_TILE);
	for (int i = 0; i < a.ni; i++) {
		double *to = s->S + (size_t)(q->from + a.i0 + i) * (size_t)s->p + (size_t)(q->from + a.j0);
		for (int j = 0; j < (diagonal ? i + 1 : a.nj); j++)
			to[j] += (double)sum[i * SCATTER_TILE + j];
	}
}

void scatter_split_add(struct scatter *s, int rows)
{
	struct scatter_split *q = s->split;
	int n = q->n, tiles = scatter_tiles(n), stripes = (n + SCATTER_TILE - 1) / SCATTER_TILE;
	divide(s, rows);
	// The largest pieces come first, so that no thread waits long at the end.
#pragma omp parallel
	{
		float *sum = mem_array(SCATTER_TILE * SCATTER_TILE, sizeof *sum);
#pragma omp for schedule(dynamic)
		for (int t = 0; t < tiles + stripes + 1; t++) {
			int c = (t - tiles) * SCATTER_TILE;
			if (t < tiles)
				add_rest(s, rows, scatter_tile(n, t), sum);
			else if (t < tiles + stripes)
				add_beside(s, rows, c, n - c < SCATTER_TILE ? n - c : SCATTER_TILE);
			else
				add_known(s, rows);
		}
		free(sum);
	}
}

void scatter_join(struct scatter *s)
{
	struct scatter_split *q = s->split;
	if (!q)
		return;
	int n = q->n, k = q->k, p = s->p;
	double *half = mem_array((size_t)n * (size_t)k + 1, sizeof *half), *to = s->S + (size_t)q->from * (size_t)p + q->from;
	if (q->from)
		cblas_dgemm(CblasRowMajor, CblasNoTrans, CblasNoTrans, n, q->from, k, 1, q->V, k, q->TE, q->from, 1,
		            s->S + (size_t)q->from * (size_t)p, p);
	// V (T^T R + T^T T V^T / 2) and its transpose make up the three terms.
	cblas_dgemm(CblasRowMajor, CblasNoTrans, CblasNoTrans, n, k, k, 0.5, q->V, k, q->TT, k, 0, half, k);
	for (int i = 0; i < n; i++)
		for (int c = 0; c < k; c++)
			half[i * k + c] += q->TR[(size_t)c * (size_t)n + (size_t)i];
#pragma omp parallel for schedule(dynamic)
	for (int t = 0; t < scatter_tiles(n); t++) {
		struct scatter_tile a = scatter_tile(n, t);
		double *tile = to + (size_t)a.i0 * (size_t)p + a.j0;
		cblas_dgemm(CblasRowMajor, CblasNoTrans, CblasTrans, a.ni, a.nj, k, 1, q->V + a.i0 * k, k, half + a.j0 * k, k, 1, tile, p);
		cblas_dgemm(CblasRowMajor, CblasNoTrans, CblasTrans, a.ni, a.nj, k, 1, half + a.i0 * k, k, q->V + a.j0 * k, k, 1, tile, p);
	}
	free(half);
	scatter_split_free(s);
}
