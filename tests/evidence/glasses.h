/* glasses: rims before drawn eyes and what their lenses mirror. */
#ifndef EVIDENCE_GLASSES_H
#define EVIDENCE_GLASSES_H
#include "face.h"
#include "light.h"

/* Draws them over the canvas; mirrored light that hides the eye becomes class reflection. */
void glasses_draw(struct canvas *canvas, const struct face *face, const float white[3], struct rng *rng);

#endif
