/* nls: non-linear least squares by Ceres, one dense block: min ½ Σ r_i(x)², lo <= x <= hi. */
#ifndef BRIDGE_NLS_H
#define BRIDGE_NLS_H
#ifdef __cplusplus
extern "C" {
#endif
#include "base/err.h"

/* The residuals r[m] at x[n], and where J is not null the Jacobian J[m][n], row-major, J_ij = dr_i/dx_j. Returns false where x is
 * not admissible; the step is then shortened. Robust weights are applied within r (square root of the weight). */
typedef bool (*nls_fn)(void *ctx, const double *x, double *r, double *J);

struct nls_conf {
	int max_iter;             // 50 when 0
	double ftol, gtol, xtol;  // Ceres' defaults (1e-6, 1e-10, 1e-8) when 0
	bool numeric;             // fn never fills J: derivatives by central differences
};

struct nls_result {
	double cost0, cost;  // ½ Σ r² before and after
	int iterations;
	bool converged;
	int rank;            // of the Jacobian at the solution
	double condition;    // of the column-scaled Jacobian
};

/* Minimises by Levenberg-Marquardt.
 * x       [n] in: start; out: solution
 * lo, hi  [n] bounds, or null
 * fn      m residuals; ctx is passed on
 * cov     [n][n] out: (JᵀJ)⁻¹ at the solution, the covariance if residuals have unit variance; or null. Parameters in the null
 *         space of a rank-deficient J get +INFINITY on the diagonal and 0 elsewhere, and result->rank < n
 * Returns false, err set, when Ceres finds no usable solution. */
bool nls_solve(struct nls_result *result, int n, double *x, const double *lo, const double *hi, int m, nls_fn fn,
               void *ctx, const struct nls_conf *conf, double *cov, struct err *err);

/* Largest difference between fn's Jacobian and central differences at x, relative to each column's norm. For tests. */
double nls_check_jacobian(int n, const double *x, int m, nls_fn fn, void *ctx);

#ifdef __cplusplus
}
#endif
#endif
