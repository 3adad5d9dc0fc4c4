/* cornea_sag: a cornea that is no surface of revolution: a conic, and what topographers measure beside it.
 *
 * z = conic(x, y) + sum of coefficients times monomials of x / rim, y / rim up to the fourth degree, mm: toricity, tilt, a
 * decentred apex, coma, trefoil. Eye frame, mm; apex near the origin, z into the eye.
 */
#ifndef PEERS_CORNEA_SAG_H
#define PEERS_CORNEA_SAG_H
#include "optics/lightpath/lightpath.h"

/* Order: x y, xx xy yy, xxx xxy xyy yyy, xxxx xxxy xxyy xyyy yyyy. */
enum { CORNEA_SAG_TERMS = 14 };

struct cornea_sag {
	struct cornea base;                // one surface: R, p, n and the rim are read
	double term[CORNEA_SAG_TERMS];     // mm at the rim
};

/* What an eye's records say: steep meridian of that radius (mm) at that angle from x; tilt about the same axes as x and y of
 * the eye (rad), and the apex off the axis (mm). */
struct cornea_sag cornea_sag_toric(const struct cornea *flat, double steep_radius, double axis, const double tilt[2], const double apex[2]);

/* Depth at (x, y) and, not null, its gradient and second derivatives (xx, xy, yy). */
double cornea_sag_depth(const struct cornea_sag *cornea, double x, double y, double gradient[2], double second[3]);

/* Unit normal at (x, y), out of the eye. */
void cornea_sag_normal(double normal[3], const struct cornea_sag *cornea, double x, double y);

/* Where light from direction w (unit, towards the light) that reaches P enters: from the path through the conic, by at most
 * `steps` Newton steps on L = n |KP| - w·K; where they lead nowhere, near a focus, by a search over the cornea. Nothing is
 * stored but the surface. K is set whatever the status. */
enum lightpath_status cornea_sag_path(double K[3], const struct cornea_sag *cornea, const double P[3], const double w[3], int steps);

#endif
