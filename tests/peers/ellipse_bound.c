#include "tests/peers/ellipse_bound.h"

#include <lapacke.h>

enum { N = ELLIPSE_N };

bool ellipse_bound(double cov_q[N][N], const struct ellipse *e, int n, const double t[n], double sigma)
{
	for (int a = 0; a < N; a++)
		for (int b = 0; b < N; b++)
			cov_q[a][b] = 0;
	for (int i = 0; i < n; i++) {
		double row[N];
		ellipse_normal_shift(row, e, t[i]);
		for (int a = 0; a < N; a++)
			for (int b = 0; b < N; b++)
				cov_q[a][b] += row[a] * row[b] / (sigma * sigma);
	}
	if (LAPACKE_dpotrf(LAPACK_ROW_MAJOR, 'L', N, &cov_q[0][0], N) || LAPACKE_dpotri(LAPACK_ROW_MAJOR, 'L', N, &cov_q[0][0], N))
		return false;
	for (int a = 0; a < N; a++)
		for (int b = a + 1; b < N; b++)
			cov_q[a][b] = cov_q[b][a];
	return true;
}
