/* scatter: mean and scatter matrix of weighted rows, one block of rows after another, in memory that does not grow with
 * their number; and what follows from them: principal components, cross moments, rank.
 *
 * Blocks are centred on their own mean before they are squared and merged by the update of Chan, Golub and LeVeque
 * (1983), so that a large mean costs no digits. As long as there are no more rows than `keep`, the rows themselves are
 * kept and components come from their singular value decomposition, without squaring; then LAPACK's dsyevr on the
 * scatter matrix: relative to the largest, singular values below about 1e-8 are not resolved.
 * Same bits on any number of threads (OpenMP, tiles of a fixed size).
 */
#ifndef MATH_SCATTER_SCATTER_H
#define MATH_SCATTER_SCATTER_H
#include <stdbool.h>

struct scatter {
	int p;            // columns
	long n;           // rows with a weight above 0
	double weight;    // sum of weights
	double *mean;     // [p]
	double *rows;     // [n][p] as given, while n <= keep; null later
	double *weights;  // [n] of the rows kept
	double *S;        // [p][p] sum of w (x - mean)(x - mean)^T, lower triangle; null while rows are kept
	int keep;
	double *work;     // [SCATTER_BLOCK + 1][p]
	struct scatter_split *split;
};

enum { SCATTER_BLOCK = 1024 };

/* keep 0: the scatter matrix from the first row on. */
void scatter_new(struct scatter *s, int p, int keep);
void scatter_free(struct scatter *s);

/* n rows [n][p], weights w[n] >= 0 (null: all 1). Every number must be finite. */
void scatter_add(struct scatter *s, long n, const double *x, const double *w);

/* The same without a copy: room for SCATTER_BLOCK rows [p], which scatter_take adds, the first n of them; what they hold is
 * lost. No other call between the two; to write to from any thread, call scatter_rows once before. */
double *scatter_rows(struct scatter *s);
void scatter_take(struct scatter *s, long n, const double *w);

/* Columns from..p-1 lie near k known directions V[p - from][k] (orthonormal columns): these are summed in double, only what
 * is left beside them in single precision, at twice the speed. Rounding is then 1e-7 of the rest, not of the whole:
 * components that stand ten times out of the rest keep 1e-9. Before the first row, keep = 0. */
void scatter_split(struct scatter *s, int from, int k, const double *V);

/* Ends a split: the rest and the known directions become one matrix. No rows after it. No effect without one. */
void scatter_join(struct scatter *s);

/* out[ni][nj]: sum of w (x_i - mean_i)(x_j - mean_j), i from i0, j from j0. */
void scatter_cross(double *out, const struct scatter *s, int i0, int ni, int j0, int nj);

/* Sum over the columns from..from+n-1 of their scatter: the total sum of squares about the mean. */
double scatter_energy(const struct scatter *s, int from, int n);

/* The k (<= n) directions of largest scatter of the columns from..from+n-1: vectors[n][k], orthonormal columns, the
 * largest number of each positive; values[k]: singular values of the centred weighted rows, largest first (values squared
 * over weight: variances). Returns how many of them stand out of rounding: the rank, at most k; the others are 0. */
int scatter_components(double *vectors, double *values, const struct scatter *s, int from, int n, int k);

#endif
