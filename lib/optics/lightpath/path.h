/* path: one light path through the front surface: the chart of the surface it is solved in, and derivatives. Shared by the scalar
 * solver (lightpath.c), the search for all paths (all.c) and the refraction function. Eye frame, mm.
 */
#ifndef OPTICS_LIGHTPATH_PATH_H
#define OPTICS_LIGHTPATH_PATH_H
#include <math.h>

#include "optics/lightpath/lightpath.h"

/* By how much the first guess bends the direction to the light towards the axis: what Snell's law gives at grazing incidence on a
 * plane, and a little more: 1 for the eye. The guess errs by 0.23 mm on average over the hemisphere, more than with 0.6 (0.18
 * mm), but Newton's method converges faster from it: to 1e-5 mm after three steps instead of 4e-3. 0, and exact, for n = 1. */
static inline double path_bend(double n)
{
	return 1.13 * sqrt(n * n - 1);
}

/* One problem: P inside; the light at a point C outside, or in the unit direction w. */
struct path {
	const struct cornea *cornea;
	const double *P, *C, *w;  // C or w is null
};

/* A point of the surface in the rational chart K = t (x, y, rho²), t = R tau, tau = 2 / (1 + p rho²), rho² = x² + y²:
 * no root, no end at the equator. Tangents of the chart are taken over t: e + (x, y) m, m = tau (−p x, −p y, 1). */
struct chart {
	double x, y, tau, rho2, K[3];
};

/* The point at chart coordinates x, y. */
struct chart chart_at(const struct cornea *cornea, double x, double y);

/* The point reached from `at` by a step along the two tangents (mm, to first order). */
struct chart chart_moved(const struct cornea *cornea, const struct chart *at, const double step[2]);

/* Unit direction u from K to the light. Returns 1 / its distance, 0 at infinity. */
double path_outward(double u[3], const struct path *path, const double K[3]);

/* L(b) − L(a) for L = |CK| + n |KP|, computed without cancellation. */
double path_length_change(const struct path *path, const double a[3], const double b[3]);

/* Gradient g and Hessian H (xx, xy, yy) of L along the tangents. Terms of the chart's second derivatives that vanish with the
 * gradient are left out: Newton's method keeps its order and converges faster. */
void path_derivatives(double g[2], double H[3], const struct path *path, const struct chart *at);

/* Direction q inside, from P's side towards K, of light that leaves K in unit direction u: Snell's law, smooth past 90 degrees of
 * incidence. Its length is n. */
void path_inside(double q[3], const struct path *path, const struct chart *at, const double u[3]);

/* Distance by which the ray refracted at K misses P, mm along two directions across it, and its Jacobian J along the tangents.
 * This form of Snell's law keeps its digits for n -> 1 at grazing incidence, and is smooth where P lies close to the surface. */
void path_miss(double miss[2], double J[2][2], const struct path *path, const struct chart *at);

/* Refines a K that is right up to rounding by at most two Newton steps on the miss. */
void path_polish(struct chart *at, const struct path *path);

/* Whether P is inside the surface, C outside, and all are finite. */
bool path_is_sound(const struct path *path);

/* The path that descent from the closed-form start leads to: a smooth function of P and of the light, which continues beyond the
 * rim and past 90 degrees of incidence. */
enum lightpath_status path_shortest(double K[3], const struct path *path);

/* The point where the ray from P inside, in direction q, leaves the surface. */
struct chart path_leave(const struct path *path, const double q[3]);

#endif
