/* quad: the cornea's light path in 128 bits (33 digits), to hold results in double and float against. Shares no code with
 * lib/optics. Eye frame, mm (optics/cornea/cornea.h).
 */
#ifndef TESTS_QUAD_H
#define TESTS_QUAD_H
#include <stdbool.h>

#include "optics/cornea/cornea.h"

typedef __float128 quad;

quad quad_sqrt(quad x);

/* The surface point over (x, y) and its unit normal, outwards. */
void quad_surface(quad K[3], quad N[3], const struct cornea *c, quad x, quad y);

/* Snell: unit direction behind the surface of light that comes from unit direction u; false in total reflection. */
bool quad_refract(quad q[3], const quad u[3], const quad N[3], quad n);

/* Where light from C (null: from direction w, of any length) to P crosses the surface, by Newton's method from (x, y), which
 * is next to it. *stretch: mm that K moves for a change of one in the sine of Snell's law. False where it does not converge. */
bool quad_path(quad K[3], double *stretch, const struct cornea *c, const double P[3], const double C[3], const double w[3],
               double x, double y);

/* How far K is from keeping Snell's law there: |n sin t - sin i|, as vectors along the surface. */
double quad_snell(const struct cornea *c, const double P[3], const double C[3], const double w[3], double x, double y);

#endif
