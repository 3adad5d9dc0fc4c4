/* beside: light that comes to a place through the tissue beside it. What the march makes of light is where it fell; in truth it comes out a little
 * aside, red further than blue: where light falls off steeply, or ends at the limbus' shadow, tissue is brighter and redder than its own light
 * makes it, and the lit side of that edge is bluer. */
#ifndef DRAW_EYE_MARCH_BESIDE_H
#define DRAW_EYE_MARCH_BESIDE_H
#include "draw/eye/march/beam.h"

/* With E(x) the irradiance of the iris plane by all beams, hard at the limbus but for the width over which the sclera begins, and the kernel
 *     K(x, y) = exp(-(|x| + |y|) / b_c) / (2 b_c)^2,  b_c = spread_c / sqrt(2)
 * of variance spread_c^2 along either axis, as that of the limbus' shadow (tissue/light/rim_shadow.h), by channel c:
 *     factor_c = (K * E_c + dark) / (E_march_c + dark)
 * over E_march, in which the march takes that shadow as soft as green light spreads. 1 where light changes evenly.
 * Returns [SCENE_BESIDE][SCENE_BESIDE][4] over the square of the maps (texel centres half a step from its edge), the fourth unused; free(). Null
 * where the tissue scatters light once only. */
float *scene_beside(const struct scene *scene, const struct scene_beams *beams);

/* Multiplies the colours of n points of the iris by it; beside: null, nothing. */
void scene_beside_put(int n, float *r, float *g, float *b, const float *x, const float *y, const float *beside, float extent);

#endif
