/* limbus_consensus: the ellipse that most edge candidates agree on, near a rough one. */
#ifndef LIMBUS_PROPOSE_CONSENSUS_H
#define LIMBUS_PROPOSE_CONSENSUS_H
#include "limbus/edge.h"

/* Every arc offers its strongest dark-to-bright steps within +- range px. For a small change of the ellipse the step
 * of an arc moves by a linear form of the change of q (ellipse_normal_shift), so that hypotheses from five arcs,
 * their support, and the final weighted fit are linear. Candidates with
 * skin outside weigh less (tint may be null). Overwrites *e. False: too few edges in the photograph. */
bool rim_consensus(struct ellipse *e, const struct grey *grey, const struct grey *tint, double range, int width,
                   int height);

#endif
