/* Principal components from the rows kept or from the scatter matrix. */
#include <float.h>
#include <lapacke.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "math/scatter/impl.h"

/* Gives each column of vectors the sign that makes its largest number positive. */
static void settle_signs(double *vectors, int n, int k)
{
	for (int c = 0; c < k; c++) {
		int top = 0;
		for (int i = 1; i < n; i++)
			if (fabs(vectors[i * k + c]) > fabs(vectors[top * k + c]) * (1 + 1e-9))
				top = i;
		bool flip = vectors[top * k + c] < 0;
		for (int i = 0; i < n && flip; i++)
			vectors[i * k + c] = -vectors[i * k + c];
	}
}

/* Singular value decomposition of the rows: d[least], vt[least][n]. Divide and conquer (dgesdd) is many times faster than the QR
 * algorithm (dgesvd), which takes over where the former does not converge, as can happen with many equal values. */
static bool decompose(double *d, double *vt, const struct scatter *s, int from, int n)
{
	int m = (int)s->n, least = m < n ? m : n;
	double *y = scatter_centred(s, from, n), *u = mem_new((size_t)m * (size_t)least + 1, sizeof *u);
	bool ok = least > 0 && !LAPACKE_dgesdd(LAPACK_ROW_MAJOR, 'S', m, n, y, n, d, u, least, vt, n);
	free(y);
	if (least > 0 && !ok) {
		double *super = mem_new((size_t)least + 1, sizeof *super);
		y = scatter_centred(s, from, n);
		ok = !LAPACKE_dgesvd(LAPACK_ROW_MAJOR, 'N', 'S', m, n, y, n, d, u, least, vt, n, super);
		free(y);
		free(super);
	}
	free(u);
	return ok;
}

/* Components from the rows kept. *resolved: values below it are rounding errors. */
static bool by_rows(double *vectors, double *values, double *resolved, const struct scatter *s, int from, int n, int k)
{
	int m = (int)s->n, least = m < n ? m : n;
	double *d = mem_new((size_t)least + 1, sizeof *d), *vt = mem_new((size_t)least * (size_t)n + 1, sizeof *vt);
	bool ok = decompose(d, vt, s, from, n);
	for (int c = 0; c < k && ok; c++) {
		values[c] = c < least ? d[c] : 0;
		for (int i = 0; i < n && c < least; i++)
			vectors[i * k + c] = vt[(size_t)c * (size_t)n + (size_t)i];
	}
	*resolved = ok ? d[0] * (m > n ? m : n) * DBL_EPSILON : 0;
	free(d);
	free(vt);
	return ok;
}

static bool by_matrix(double *vectors, double *values, double *resolved, const struct scatter *s, int from, int n, int k)
{
	double *A = mem_array((size_t)n * (size_t)n + 1, sizeof *A), *d = mem_new((size_t)n + 1, sizeof *d);
	double *z = mem_new((size_t)n * (size_t)k + 1, sizeof *z);
	lapack_int *support = mem_new(2 * (size_t)k + 2, sizeof *support), found = 0;
	// Column-major upper is row-major lower: no copy inside LAPACKE.
	for (int i = 0; i < n; i++)
		memcpy(A + (size_t)i * (size_t)n, s->S + (size_t)(from + i) * (size_t)s->p + from, (size_t)(i + 1) * sizeof *A);
	bool ok = !LAPACKE_dsyevr(LAPACK_COL_MAJOR, 'V', 'I', 'U', n, A, n, 0, 0, n - k + 1, n, 0, &found, d, z, n, support)
	          && found == k;
	for (int c = 0; c < k && ok; c++) {
		values[c] = sqrt(d[k - 1 - c] > 0 ? d[k - 1 - c] : 0);
		for (int i = 0; i < n; i++)
			vectors[i * k + c] = z[(size_t)(k - 1 - c) * (size_t)n + (size_t)i];
	}
	*resolved = ok ? sqrt(fmax(d[k - 1], 0) * n * DBL_EPSILON) : 0;
	free(A);
	free(d);
	free(z);
	free(support);
	return ok;
}

int scatter_components(double *vectors, double *values, const struct scatter *s, int from, int n, int k)
{
	double resolved = 0;
	memset(vectors, 0, (size_t)n * (size_t)k * sizeof *vectors);
	memset(values, 0, (size_t)k * sizeof *values);
	if (!n || !k || !s->n)
		return 0;
	if (!(s->S ? by_matrix : by_rows)(vectors, values, &resolved, s, from, n, k))
		return 0;
	double mean2 = 0;  // a constant column differs from its mean by rounding
	for (int i = from; i < from + n; i++)
		mean2 += s->mean[i] * s->mean[i];
	resolved = fmax(resolved, 8 * DBL_EPSILON * sqrt(s->weight * mean2));
	int rank = 0;
	while (rank < k && values[rank] > resolved)
		rank++;
	for (int c = rank; c < k; c++) {
		values[c] = 0;
		for (int i = 0; i < n; i++)
			vectors[i * k + c] = 0;
	}
	settle_signs(vectors, n, k);
	return rank;
}
