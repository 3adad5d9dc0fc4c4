/* deform_terms: constants of a vertex in algorithm 1 (deform.h), which deform.c and the interactive page's shader
 * (render/viewer/pose.glsl) share. Lengths mm, px of the modelling camera. */
#ifndef RIG_DEFORM_TERMS_H
#define RIG_DEFORM_TERMS_H
#include "rig/rig.h"

struct deform_terms {
	float mean[2], basis[RIG_BASIS];  // u = mean + basis e: x, then y
	float offset[3], lean[3];         // rest less the skull map there: position, normal
	float tau0[3];                    // at rest: unit direction from the globe's centre
};

/* Whether a vertex that is not a globe's can move. */
bool deform_terms_moves(const struct rig *rig, int vertex);

/* Computes the constants of one vertex. terms: overwritten. */
void deform_terms_of(struct deform_terms *terms, const struct rig *rig, int vertex);

#endif
