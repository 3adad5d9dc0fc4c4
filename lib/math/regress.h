/* regress: linear regression of several outputs from centred cross moments, with ridge, its rank found. */
#ifndef MATH_REGRESS_H
#define MATH_REGRESS_H

/* b[r][q]: slopes of r outputs on q inputs, out of Gxx[q][q] (sum of w x x^T, centred), Gxy[q][r] (sum of w x y^T) and the
 * sum of weights. Inputs are scaled to variance 1 first; ridge >= 0 is added to their correlation matrix (0: least
 * squares). Directions whose eigenvalue is below 1e-10 of the largest are not distinguishable from constant: they get
 * nothing (the shortest solution), as do inputs that do not vary beyond the rounding of `mean`[q] (null: 0).
 * Returns the rank. */
int regress(double *b, int q, int r, const double *Gxx, const double *Gxy, double weight, const double *mean,
            double ridge);

/* The moments themselves: n rows x[n][q], y[n][r], weights w[n] >= 0; means are returned in mx[q], my[r]. Returns the sum
 * of weights. */
double regress_moments(double *Gxx, double *Gxy, double *mx, double *my, long n, int q, int r, const double *x,
                       const double *y, const double *w);

#endif
