/* albedo: the iris without its light. */
#ifndef DRAW_EYE_ALBEDO_H
#define DRAW_EYE_ALBEDO_H
#include "draw/eye/scene.h"

/* What a diffuse surface in place of the iris would need as albedo to look like it, seen along the axis: its pattern in light that comes
 * evenly from everywhere, the photographed colour times the model's ratio between that light and the photograph's (colour.h); its mean halfway
 * between that and the one in `lit` (camera's frame), turned round the axis. What the cornea takes
 * of light on its way in is part of it, as programs that draw triangles light the iris as if there were none; on the way out nothing is.
 * Call after scene_fit_colour.
 * Returns [n][n][3] of level 0, linear Rec. 709, within 0..1; image_free. */
struct image scene_albedo(const struct scene *scene, const struct envmap *lit);

#endif
