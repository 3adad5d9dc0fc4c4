/* walk: the likeliest path of something that goes on a little from one measurement to the next (a random walk, the smoother of Rauch,
 * Tung and Striebel 1965), by elimination of its three diagonals. */
#ifndef MATH_WALK_H
#define MATH_WALK_H

/* x[n], measured with errors sigma[n], of a path that goes on by about `step` (one standard deviation) from one to the next: overwritten
 * by the path. room[n]: scratch. */
void walk_smooth(long n, double *x, const double *sigma, double step, double *room);

#endif
