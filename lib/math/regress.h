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

/* How far inputs lie from those that were learnt from: reach[q][q + 1], so that h = |reach [x; 1]|^2 is the leverage of x,
 * (x - mean)' Gxx^-1 (x - mean): the variance that the slopes leave in what is foretold for x, over that of one row. A row of
 * weight w that was learnt from has h <= 1 / w; with h above 1 less than one row tells of x: extrapolation that no input's
 * own range shows (Hoaglin and Welsch 1978). Directions that `regress` leaves out count as 1e-10 of the largest.
 * least[q]: an input that varies by no more is constant, and h = 1 where it differs by so much; INFINITY: it does not count.
 * All NAN where Gxx is not numbers. */
void regress_reach(double *reach, int q, const double *Gxx, double weight, const double *mean, const double *least);

/* The leverage h of x[q]; NAN where x is. */
double regress_leverage(const double *reach, int q, const double *x);

/* The moments themselves: n rows x[n][q], y[n][r], weights w[n] >= 0; means are returned in mx[q], my[r]. Returns the sum
 * of weights. */
double regress_moments(double *Gxx, double *Gxy, double *mx, double *my, long n, int q, int r, const double *x,
                       const double *y, const double *w);

#endif
