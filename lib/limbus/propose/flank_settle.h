/* flank_settle: */
#ifndef LIMBUS_PROPOSE_FLANK_SETTLE_H
#define LIMBUS_PROPOSE_FLANK_SETTLE_H
#include "limbus/propose/seek.h"

/* The circle made an ellipse on the longest stretch of such edge near it; few arcs far from the rest, the lids', do not
 * count. score: mean step along it, arcs without one counted as 0. False: no edge is left. */
bool limbus_flank_settle(struct seek_found *found, const struct photo *photo);

/* Share of the photograph, what is dark left out, that is less warm in colour than what lies beside the ellipse: little,
 * where that is sclera. */
double limbus_flank_cooler(const struct photo *photo, const struct ellipse *e);

#endif
