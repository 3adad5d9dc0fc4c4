/* ellipse: ellipses in the plane: parameters, points, distances. Fits: ellipse_fit.h.
 *
 * Two parametrisations. `struct ellipse` is what people read. Fits and covariances use q = (cx, cy, r, e, f):
 * the curve is c + S u for unit u, S = [[r + e, f], [f, r - e]], so r = (a + b) / 2 and
 * (e, f) = (a - b) / 2 (cos 2 angle, sin 2 angle). It is smooth through the circle, where the angle is not defined.
 */
#ifndef MATH_ELLIPSE_H
#define MATH_ELLIPSE_H
#include <stdbool.h>

#include "math/ellipse_type.h"

enum { ELLIPSE_N = 5 };  // parameters of an ellipse

void ellipse_to_q(double q[ELLIPSE_N], const struct ellipse *e);
/* Angle in [0, pi). False when S is not positive definite: no ellipse. */
bool ellipse_from_q(struct ellipse *e, const double q[ELLIPSE_N]);

/* Moves, resizes and turns e uphill, one parameter of q after the other, with steps from `step` down to `end` px; never
 * narrower than b = least_aspect a. Returns the worth reached. */
double ellipse_climb(struct ellipse *e, double step, double end, double least_aspect,
                     double (*worth)(const void *ctx, const struct ellipse *e), const void *ctx);

/* 1 sigma of cx, cy, a, b, angle from the covariance of q; the angle's is at most pi / sqrt(12), that of no idea. */
void ellipse_sigma(double sigma[ELLIPSE_N], const struct ellipse *e, const double cov_q[ELLIPSE_N][ELLIPSE_N]);

/* Point and outward unit normal at eccentric angle t (from the major axis). */
void ellipse_point(double p[2], double normal[2], const struct ellipse *e, double t);

/* Signed distance of p, positive outside; *t the eccentric angle of the nearest point. Newton to 1e-12. */
double ellipse_distance(double *t, const struct ellipse *e, const double p[2]);

/* dp·n / dq: how far the curve moves along its outward normal at eccentric angle t. */
void ellipse_normal_shift(double row[ELLIPSE_N], const struct ellipse *e, double t);

/* A x² + B xy + C y² + D x + E y + F = 0. False: not a real ellipse. */
bool ellipse_from_conic(struct ellipse *e, const double conic[6]);
void ellipse_to_conic(double conic[6], const struct ellipse *e);

/* Ramanujan's second formula. */
double ellipse_perimeter(const struct ellipse *e);

#endif
