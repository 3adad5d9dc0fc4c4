/* ellipse: ellipses in the plane: parameters, points, distances. Fits: ellipse_fit.h.
 *
 * There are two parametrisations. `struct ellipse` is for people. Fits and covariances use q = (cx, cy, r, e, f): the curve is c
 * + S u for unit vectors u, S = [[r + e, f], [f, r - e]], so that r = (a + b) / 2 and (e, f) = (a - b) / 2 (cos 2 angle, sin 2
 * angle). q is smooth through the circle, where the angle is not defined. Units px and radians; x right, y down.
 */
#ifndef MATH_ELLIPSE_H
#define MATH_ELLIPSE_H
#include <stdbool.h>

#include "math/ellipse_type.h"

enum { ELLIPSE_N = 5 };  // parameters of an ellipse

/* q of an ellipse. */
void ellipse_to_q(double q[ELLIPSE_N], const struct ellipse *e);
/* S (x, y): what leads from the centre to the ellipse where (x, y) is a unit vector. */
void ellipse_span(double d[2], const struct ellipse *e, double x, double y);
/* The ellipse of q, angle in [0, pi). Returns false when S is not positive definite, that is, q no ellipse. */
bool ellipse_from_q(struct ellipse *e, const double q[ELLIPSE_N]);

/* Maximises `worth` over the ellipse by coordinate ascent on q, with steps from `step` halved down to `end`, px.
 * e             in: start; out: the best found
 * least_aspect  b / a is kept above it
 * ctx           passed to worth
 * Returns the worth reached. */
double ellipse_climb(struct ellipse *e, double step, double end, double least_aspect,
                     double (*worth)(const void *ctx, const struct ellipse *e), const void *ctx);

/* Standard deviations of cx, cy, a, b, angle from the covariance of q. That of the angle is at most pi / sqrt(12), the standard
 * deviation of an angle that is entirely unknown. */
void ellipse_sigma(double sigma[ELLIPSE_N], const struct ellipse *e, const double cov_q[ELLIPSE_N][ELLIPSE_N]);

/* Point and outward unit normal at eccentric angle t (from the major axis). */
void ellipse_point(double p[2], double normal[2], const struct ellipse *e, double t);

/* The same at n angles. */
void ellipse_points(int n, double p[n][2], double normal[n][2], const struct ellipse *e, const double t[n]);

/* Signed distance of p, positive outside; *t: eccentric angle of the nearest point. Newton's method, to 1e-12. */
double ellipse_distance(double *t, const struct ellipse *e, const double p[2]);

/* The same of n points. */
void ellipse_distances(int n, double d[n], double t[n], const struct ellipse *e, const double p[n][2]);

/* The largest of the distance of the centres and the differences of the semi-axes. */
double ellipse_apart(const struct ellipse *e, const struct ellipse *f);

/* row = dp·n / dq: the derivative of the curve's position along its outward normal n at eccentric angle t by q. */
void ellipse_normal_shift(double row[ELLIPSE_N], const struct ellipse *e, double t);
/* The same where the normal at t is known. */
void ellipse_shift_along(double row[ELLIPSE_N], const double normal[2], const struct ellipse *e, double t);

/* The ellipse of the conic A x² + B xy + C y² + D x + E y + F = 0, coefficients in this order, and back. Returns false when the
 * conic is no real ellipse. */
bool ellipse_from_conic(struct ellipse *e, const double conic[6]);
void ellipse_to_conic(double conic[6], const struct ellipse *e);

/* Perimeter, px, by Ramanujan's second formula. */
double ellipse_perimeter(const struct ellipse *e);

#endif
