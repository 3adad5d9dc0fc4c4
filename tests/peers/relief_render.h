/* relief_render: a thickness map as the relief's forward model (tissue/relief/relief.h) shows it, at every texel. */
#ifndef TESTS_RELIEF_RENDER_H
#define TESTS_RELIEF_RENDER_H
#include "tissue/relief/relief.h"

/* Linear Rec. 709 of a thickness map as the photograph would show it: exposure, white error, veil. out: R, G, B, new. */
bool relief_render(struct image *out, const struct image *thickness, double extent, const double white[3],
                   const double x[PIGMENT_N], const struct pigment_conf *pigment, const struct relief_conf *conf,
                   struct err *err);

#endif
