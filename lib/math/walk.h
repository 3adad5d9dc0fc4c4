/* walk: smoothing of a random walk that is measured with noise (the smoother of Rauch, Tung and Striebel 1965), by elimination of
 * the tridiagonal normal equations. */
#ifndef MATH_WALK_H
#define MATH_WALK_H

/* Replaces measurements by the most probable path.
 * x      [n] in: measurements; out: the path
 * sigma  [n] standard deviations of the measurements
 * step   standard deviation of the path's step from one element to the next
 * room   [n] scratch */
void walk_smooth(long n, double *x, const double *sigma, double step, double *room);

#endif
