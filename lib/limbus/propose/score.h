/* score: the support of an ellipse by edges that are dark inside and bright outside. */
#ifndef LIMBUS_PROPOSE_SCORE_H
#define LIMBUS_PROPOSE_SCORE_H
#include "limbus/image.h"

enum score_reach { SCORE_WIDE, SCORE_NARROW };  // distance over which the contrast is taken

/* Mean over the ellipse of the Weber contrast across it, relative to `contrast` and capped at 1; 0..1. The contrast of a point is
 * the smaller of two distances', so that a thin dark line does not count as an edge. */
double score_ellipse(const struct grey *grey, const struct ellipse *e, double contrast, enum score_reach reach);

/* The same; but 0 as soon as it is known to be less than `least`. */
double score_ellipse_above(const struct grey *grey, const struct ellipse *e, double contrast, enum score_reach reach, double least);

/* Hill climbing of score_ellipse over the five parameters of e, one after the other, with steps from `step` down to `end` px.
 * e: in: start; out: the local maximum. Returns its score. */
double score_climb(const struct grey *grey, struct ellipse *e, double step, double end, double contrast,
                   enum score_reach reach);

#endif
