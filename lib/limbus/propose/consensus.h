/* consensus: refines a rough ellipse by RANSAC over edge candidates. */
#ifndef LIMBUS_PROPOSE_CONSENSUS_H
#define LIMBUS_PROPOSE_CONSENSUS_H
#include "limbus/edge.h"
#include "math/ellipse_fit.h"

/* Refines an ellipse by RANSAC. The candidates are the strongest dark-to-bright steps of every arc within +- range px. For a small
 * change of the ellipse the step of an arc moves by a linear form of the change of q (ellipse_normal_shift): hypotheses from five
 * arcs, their support and the final weighted fit are linear.
 * e              in: rough; out: refined
 * tint           pyramid.tint: candidates with skin outside weigh less; may be null
 * width, height  of the photograph, px
 * False when too few edges lie in the photograph. */
bool rim_consensus(struct ellipse *e, const struct grey *grey, const struct grey *tint, double range,
                   const struct ellipse_prior *known, int width, int height);

#endif
