/* limbus_score: how well an ellipse lies on an edge that is dark inside and bright outside. */
#ifndef LIMBUS_PROPOSE_SCORE_H
#define LIMBUS_PROPOSE_SCORE_H
#include "limbus/image.h"

enum score_reach { SCORE_WIDE, SCORE_NARROW };  // how exactly the ellipse must lie on the edge

/* Mean over the edge of the Weber contrast across it, measured over two distances (a thin dark line passes the near
 * one only), each point capped at 1 = `contrast`. 0..1. */
double score_ellipse(const struct grey *grey, const struct ellipse *e, double contrast, enum score_reach reach);

/* Moves, resizes and turns e uphill, one parameter of q after the other, with steps from `step` down to `end` px.
 * Returns the score reached. */
double score_climb(const struct grey *grey, struct ellipse *e, double step, double end, double contrast,
                   enum score_reach reach);

#endif
