/* flank_settle: refines a circle of flank.h to an ellipse, and tests the colour beside it. */
#ifndef LIMBUS_PROPOSE_FLANK_SETTLE_H
#define LIMBUS_PROPOSE_FLANK_SETTLE_H
#include "limbus/propose/seek.h"

/* Refines a circle to an ellipse by hill climbing on the mean step along it.
 * found  in: circle; out: ellipse, score: mean step along it, arcs without a step counted as 0
 * False when no edge is left. */
bool limbus_flank_settle(struct seek_found *found, const struct photo *photo);

/* Share of the photograph's light pixels whose colour is less warm (red against blue) than what lies beside the ellipse: small
 * where that is sclera. */
double limbus_flank_cooler(const struct photo *photo, const struct ellipse *e);

#endif
