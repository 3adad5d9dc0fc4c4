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

/* The same of a path that keeps its speed but for random changes (integrated random walk: the cubic smoothing spline of the measurements), by
 * elimination of the normal equations, of two diagonals on either side.
 * bend   standard deviation of the change of step from one element to the next
 * room   [2 n] scratch */
void walk_glide(long n, double *x, const double *sigma, double bend, double *room);

/* Noise of such a path's samples x (NAN: not known), and how its step changes, by the median sizes of its third and second differences.
 * room   [n] scratch */
void walk_unrest(double *noise, double *bend, long n, const double *x, double *room);

#endif
