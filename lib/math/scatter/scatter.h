/* scatter: mean and scatter matrix of weighted rows, added block by block in memory that does not grow with their number; and
 * from them principal components, cross moments and rank.
 *
 * Each block is centred on its own mean before it is squared, and merged by the update of Chan, Golub and LeVeque (1983), so that a
 * large mean costs no digits. Up to `keep` rows are kept as they are, and components then come from their singular value
 * decomposition, without squaring; with more rows, from the eigenvectors of the scatter matrix (LAPACK's dsyevr), where singular
 * values below about 1e-8 of the largest are not resolved.
 * The same bits on any number of threads (OpenMP, tiles of a fixed size).
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

/* Begins with no rows of p columns. keep: number of rows up to which they are kept; 0: the scatter matrix from the first row on.
 * scatter_free. */
void scatter_new(struct scatter *s, int p, int keep);
void scatter_free(struct scatter *s);

/* Adds rows x[n][p] of weights w[n] >= 0 (null: all 1). Every number must be finite. */
void scatter_add(struct scatter *s, long n, const double *x, const double *w);

/* Adds rows without a copy: scatter_rows returns room for SCATTER_BLOCK rows of p columns, owned by s, and scatter_take adds the
 * first n of them and overwrites them. No other call may come between the two. The first call of scatter_rows allocates: threads
 * may use it after that. */
double *scatter_rows(struct scatter *s);
void scatter_take(struct scatter *s, long n, const double *w);

/* Declares that columns from..p-1 lie near k known directions V[p - from][k] (orthonormal columns): the part along them is then
 * summed in double, the residual in single precision, at twice the speed. Rounding is 1e-7 of the residual, not of the whole;
 * components ten times larger than the residual keep 1e-9. To be called before the first row, with keep = 0. */
void scatter_split(struct scatter *s, int from, int k, const double *V);

/* Ends a split: adds residual and known directions up in s->S. No rows may follow. Does nothing without a split. */
void scatter_join(struct scatter *s);

/* out[ni][nj]: sum of w (x_i - mean_i)(x_j - mean_j), i from i0, j from j0. */
void scatter_cross(double *out, const struct scatter *s, int i0, int ni, int j0, int nj);

/* Total sum of squares about the mean of the columns from..from+n-1. */
double scatter_energy(const struct scatter *s, int from, int n);

/* Principal components of the columns from..from+n-1.
 * vectors  [n][k] out: the k <= n directions of largest scatter, orthonormal columns, the largest number of each positive
 * values   [k] out: singular values of the centred weighted rows, largest first (values² / weight: variances)
 * Returns the numerical rank, at most k; vectors and values beyond it are 0. */
int scatter_components(double *vectors, double *values, const struct scatter *s, int from, int n, int k);

#endif
