/* limbus_flank: eyes found by the two sides of the limbus, where it meets the sclera. Lids cover it above and below,
 * windows shine in it, warm light colours the sclera and dark skin is darker than it; at the sides the sclera is still
 * lighter than the iris, in every channel. For photographs that the search by whiteness (limbus_seek) does not settle.
 */
#ifndef LIMBUS_PROPOSE_FLANK_H
#define LIMBUS_PROPOSE_FLANK_H
#include "limbus/propose/seek.h"

/* Circles with a clear step at their sides, best first; at most SEEK_MAX; returns how many. score: of the step, in
 * natural logarithms of brightness. Radii lo to hi px. hint: x, y, radius px, or null: centres within 0.7 of its radius
 * and radii within a factor 1.5 alone. */
int limbus_flanks(struct seek_found out[SEEK_MAX], const struct photo *photo, const double *hint, double lo, double hi);

enum { FLANK_ROUND = 3 };
#define FLANK_GAP 0.15  // of the radius: steps are measured over so much on both sides

/* The clearest circles round an ellipse, 1.5 to 4.5 times as large, best first: where that is a pupil, its limbus is
 * one of them. gap: share of the radius that steps are measured over, each way. Returns how many; score as in limbus_flanks, at most 1.4. */
int limbus_flank_around(struct seek_found out[FLANK_ROUND], const struct photo *photo, const struct ellipse *e, double gap);

#endif
