/* ellipse: ellipses in the plane, and fitting them to edge points.
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

/* Direct least squares fit (Halir and Flusser 1998, numerically stable Fitzgibbon), coordinates normalised.
 * weight may be null. False: fewer than 5 points, or they hold no ellipse. */
bool ellipse_fit_direct(struct ellipse *e, int n, const double p[n][2], const double *weight);

struct ellipse_fit {
	double sigma;       // robust scale of the distances, px
	double cov_q[ELLIPSE_N][ELLIPSE_N];
	int iterations;
	double inliers;     // sum of the Tukey weights over n
};

/* Maximum likelihood fit, robust: geometric distances, iteratively reweighted with Tukey's biweight (c = 5.5, 97.5 %
 * efficient on clean data).
 * start   e as given, when `have_start`; else random five-point samples (seeded), the best by truncated distance
 * sigma   0: scale from the median absolute deviation; else the known noise of the points, px
 * weights may be null; in: prior weight of a point (1 / variance, relative); out[n] (may be null): Tukey weights
 * Returns false when no ellipse is supported. */
bool ellipse_fit_robust(struct ellipse *e, struct ellipse_fit *fit, int n, const double p[n][2],
                        const double *prior, double *out, double sigma, bool have_start);

/* Cramér-Rao bound on q for noise sigma (px, along the normal) at the eccentric angles t[n]. False: singular. */
bool ellipse_bound(double cov_q[ELLIPSE_N][ELLIPSE_N], const struct ellipse *e, int n, const double t[n],
                   double sigma);

/* Ramanujan's second formula. */
double ellipse_perimeter(const struct ellipse *e);

#endif
