/* light_case: light paths whose K is known because they are built forwards: a point K of the cornea, a direction
 * to the light, Snell in long double, a point P on the refracted ray. Shares no code with lib/optics.
 */
#ifndef TESTS_LIGHT_CASE_H
#define TESTS_LIGHT_CASE_H
#include <stdbool.h>

#include "math/rng.h"
#include "optics/cornea/cornea.h"

struct light_case {
	struct cornea cornea;
	double P[3], K[3];  // mm
	double w[3];        // unit, towards the light
	double C[3];        // a point in that direction, 1 mm to 10 km from K
	double cos_i;
	double spread[2];  // mm that K moves, at most, when P moves by 1 mm across the ray: large near a focus; for w, C
};

/* What may be drawn. */
struct light_range {
	bool any_cornea;          // R 5-12, p 0-2, n 1-2, any rim; or the eye's R 7.8, p 0.75, n 1.336, rim 5.85
	double depth[2], radius;  // of P, mm: the iris plane and what lies round it
	double behind_deg;        // largest angle between w and the axis: 90 is the hemisphere
	double grazing_deg[2];    // incidence drawn between these
};

void light_case_draw(struct light_case *out, struct rng *rng, const struct light_range *range);

/* All physical paths of a problem in the plane y = 0 (P[1] = w[1] = C[1] = 0), by a scan of the arc inside the rim and
 * bisection in long double. C null: light from direction w. Returns their number, K_x ascending. */
int light_case_bracketed(double K[][3], int max, const struct cornea *cornea, const double P[3], const double C[3],
                         const double w[3]);

/* |n sin t − sin i| as vectors along the surface, in long double, of the path through K (taken on the surface at its
 * x, y). */
double light_case_snell(const struct cornea *cornea, const double P[3], const double C[3], const double w[3],
                        const double K[3]);

/* Whether K is the right answer, or another physical path of the same problem: on the surface inside the rim, lit from
 * outside, Snell's law kept to 1e-12 (to 1e-15 next to K: at a focus two paths meet). */
enum light_verdict { LIGHT_RIGHT, LIGHT_OTHER_PATH, LIGHT_WRONG };
enum light_verdict light_case_judge(const struct light_case *c, bool point, const double K[3], double tolerance);

#endif
