/* regress: linear (ridge) regression of several outputs from centred moments, with numerical rank, and the leverage of new
 * inputs. */
#ifndef MATH_REGRESS_H
#define MATH_REGRESS_H

/* Regresses r outputs on q inputs.
 * b       [r][q] out: slopes
 * Gxx     [q][q] sum of w x x^T over rows, x centred
 * Gxy     [q][r] sum of w x y^T, centred
 * weight  sum of w
 * mean    [q] of the inputs, or null (0): an input that varies by no more than the rounding of its mean gets slope 0
 * ridge   >= 0, added to the correlation matrix of the inputs (0: least squares)
 * Directions of the correlation matrix with an eigenvalue below 1e-10 of the largest get nothing (the minimum-norm solution).
 * Returns the rank. */
int regress(double *b, int q, int r, const double *Gxx, const double *Gxy, double weight, const double *mean,
            double ridge);

/* Prepares the leverage of inputs (Hoaglin and Welsch 1978): h = |reach [x; 1]|^2 = (x - mean)' Gxx^-1 (x - mean), the variance
 * of a prediction for x due to the slopes, over the variance of one row. A training row of weight w has h <= 1 / w; h > 1 is
 * extrapolation, which the ranges of single inputs need not show.
 * reach  [q][q + 1] out; all NAN where Gxx is not finite
 * least  [q] an input that varies by no more counts as constant, and h = 1 where x differs from it by so much; INFINITY: the
 *        input does not count
 * Directions that `regress` leaves out count with an eigenvalue of 1e-10 of the largest. */
void regress_reach(double *reach, int q, const double *Gxx, double weight, const double *mean, const double *least);

/* The leverage h of x[q]; NAN where x is. */
double regress_leverage(const double *reach, int q, const double *x);

/* Computes the centred moments of rows x[n][q], y[n][r] of weights w[n] >= 0: Gxx[q][q], Gxy[q][r], means mx[q] and my[r].
 * Returns the sum of weights. */
double regress_moments(double *Gxx, double *Gxy, double *mx, double *my, long n, int q, int r, const double *x,
                       const double *y, const double *w);

#endif
