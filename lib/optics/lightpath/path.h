/* lightpath_path: one light path through the front surface: the chart it is solved in, and derivatives. Shared by
 * the scalar solver (lightpath.c), the search for all paths and the irradiance gain. Eye frame, mm.
 */
#ifndef OPTICS_LIGHTPATH_PATH_H
#define OPTICS_LIGHTPATH_PATH_H
#include <math.h>

#include "optics/lightpath/lightpath.h"

/* How far the first guess bends the direction to the light towards the axis: what Snell's law does at grazing incidence
 * on a plane, and a little more: 1 for the eye. It leaves 0.23 mm on average over the hemisphere, more than 0.6 does (0.18),
 * but where Newton's steps shrink faster: 1e-5 mm after three, not 4e-3. 0, and exact, where nothing refracts. */
static inline double path_bend(double n)
{
	return 1.13 * sqrt(n * n - 1);
}

/* One problem: P inside; outside a point C, or the unit direction w. */
struct path {
	const struct cornea *cornea;
	const double *P, *C, *w;  // C or w is null
};

/* A point of the surface in the rational chart K = t (x, y, rho²), t = R tau, tau = 2 / (1 + p rho²), rho² = x² + y²:
 * no root, no end at the equator. Tangents of the chart are taken over t: e + (x, y) m, m = tau (−p x, −p y, 1). */
struct chart {
	double x, y, tau, rho2, K[3];
};

struct chart chart_at(const struct cornea *cornea, double x, double y);

/* The point reached by a step along the tangents (mm, to first order). */
struct chart chart_moved(const struct cornea *cornea, const struct chart *at, const double step[2]);

/* Unit direction from K to the light, and 1 / its distance (0 at infinity). */
double path_outward(double u[3], const struct path *path, const double K[3]);

/* L(b) − L(a) of L = |CK| + n |KP|, without cancellation. */
double path_length_change(const struct path *path, const double a[3], const double b[3]);

/* Gradient and Hessian (xx, xy, yy) of L over the tangents; the terms of the chart's second derivatives that
 * vanish with the gradient are left out, which keeps Newton's order and makes it converge faster. */
void path_derivatives(double g[2], double H[3], const struct path *path, const struct chart *at);

/* Direction inside, from P's side towards K, of light that leaves K in unit direction u; smooth past 90 degrees of
 * incidence. Length n. */
void path_inside(double q[3], const struct path *path, const struct chart *at, const double u[3]);

/* How far the ray that K refracts passes by P, mm along two directions across it, and the Jacobian over the tangents:
 * Snell's law in a form that keeps its digits where n -> 1 meets grazing incidence, and is smooth where P lies close to
 * the surface. */
void path_miss(double miss[2], double J[2][2], const struct path *path, const struct chart *at);

/* At most two Newton steps on the miss, from a K that is right but for rounding. */
void path_polish(struct chart *at, const struct path *path);

/* P inside the surface, C outside, all of them numbers. */
bool path_is_sound(const struct path *path);

/* The path the closed-form start descends to: a smooth function of P and of the light, which continues beyond the rim and
 * past 90 degrees of incidence. */
enum lightpath_status path_shortest(double K[3], const struct path *path);

/* Where the ray from P inside, in direction q, leaves the surface. */
struct chart path_leave(const struct path *path, const double q[3]);

#endif
