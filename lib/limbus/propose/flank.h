/* flank: detects eyes by the two sides of the limbus, where it meets the sclera, for photographs in which the search by whiteness
 * (seek.h) fails. Lids cover the limbus above and below, windows reflect in it, warm light colours the sclera; at its two sides the
 * sclera is still lighter than the iris in every channel.
 */
#ifndef LIMBUS_PROPOSE_FLANK_H
#define LIMBUS_PROPOSE_FLANK_H
#include "limbus/propose/seek.h"

/* Circles with a clear step at both sides, best first.
 * out     score: height of the step, natural logarithm of brightness
 * hint    x, y, radius px, or null: restricts centres to 0.7 of its radius and radii to a factor 1.5
 * lo, hi  range of radii, px
 * Returns how many, at most SEEK_MAX. */
int limbus_flanks(struct seek_found out[SEEK_MAX], const struct photo *photo, const double *hint, double lo, double hi);

enum { FLANK_ROUND = 3 };
#define FLANK_GAP 0.15  // share of the radius, on either side of the edge, over which a step is measured

/* The clearest circles round an ellipse, 1.5 to 4.5 times as large, best first: if the ellipse is a pupil, one of them is its
 * limbus. gap: share of the radius over which steps are measured, each way. Returns how many; score as in limbus_flanks, at most
 * 1.4. */
int limbus_flank_around(struct seek_found out[FLANK_ROUND], const struct photo *photo, const struct ellipse *e, double gap);

#endif
