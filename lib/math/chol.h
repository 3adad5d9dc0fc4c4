/* chol: Cholesky's solution of tiny symmetric positive definite systems, in place and inline, for inner loops where LAPACK's
 * overhead would be most of the time. */
#ifndef MATH_CHOL_H
#define MATH_CHOL_H
#include <math.h>
#include <stdbool.h>

/* Solves a x = b.
 * a[n][stride]  row-major, lower triangle used; overwritten by the factor L
 * b[n]          overwritten by the solution
 * Returns false when a is not positive definite. */
static inline bool chol_solve(int n, int stride, double *a, double *b)
{
	for (int j = 0; j < n; j++) {
		for (int i = j; i < n; i++) {
			double sum = a[i * stride + j];
			for (int k = 0; k < j; k++)
				sum -= a[i * stride + k] * a[j * stride + k];
			if (i == j && !(sum > 0))
				return false;
			a[i * stride + j] = i == j ? sqrt(sum) : sum / a[j * stride + j];
		}
	}
	for (int i = 0; i < n; i++) {
		for (int k = 0; k < i; k++)
			b[i] -= a[i * stride + k] * b[k];
		b[i] /= a[i * stride + i];
	}
	for (int i = n - 1; i >= 0; i--) {
		for (int k = i + 1; k < n; k++)
			b[i] -= a[k * stride + i] * b[k];
		b[i] /= a[i * stride + i];
	}
	return true;
}

#endif
