/* rim_edge: where the limbus' shadow ends on the iris, by the photograph. */
#ifndef DRAW_EYE_RIM_EDGE_H
#define DRAW_EYE_RIM_EDGE_H
#include "draw/eye/march/beam.h"

/* How far beyond the limbus that is seen light still comes in, or how much higher the iris' root lies than its plane, no photograph from before the eye
 * tells but by that shadow. Sets scene->rim.edge, and beams->beside with it, to the most probable place:
 *     N / 2 ln sum (d - ring mean of d)^2 + offset^2 / (2 prior^2),  d = ln luminance of photograph over model,
 * over the outer iris that the photograph shows, N its area over that of a patch whose errors belong together. Its mean over each circle is the iris'
 * own (own_light.h): light that comes evenly from all sides tells nothing, and the prior holds.
 * texture: of level 0, R, G, B, W; C: the camera, in the eye's frame; beams: of the photograph's light */
void scene_rim_edge_fit(struct scene *scene, const float *texture, const double C[3], struct scene_beams *beams);

#endif
