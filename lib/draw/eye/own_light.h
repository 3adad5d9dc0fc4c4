/* own_light: what the photograph's light did that the model does not know of: shadows of lids and brows, light nearer than the sky, a pose
 * that is a degree off. It belongs to that light, not to the iris, and another light does not show it. */
#ifndef DRAW_EYE_OWN_LIGHT_H
#define DRAW_EYE_OWN_LIGHT_H
#include "draw/eye/march/beam.h"

/* Splits the ratio of photograph to model at level 0: what changes over more than conf.albedo_mm goes, in its luminance, to scene->own_light
 * and is taken out of level[0].colour. Its mean over each circle round the pupil is the iris' own, of which thickness and pigment have a profile,
 * while a light comes from somewhere; that, its hue, which is the pigments', and all that is finer stay there as the iris' albedo, which is
 * bounded to conf.albedo_most either way. Level 0 has colour and model, and scene->gain is set; the levels below are made afterwards.
 * beams: of the photograph's light. */
void scene_own_light_make(struct scene *scene, const struct scene_beams *beams);

/* How much of own_light a light shows, 0..1, by how far its mean direction (luminance; eye's frame; shorter for lights from all sides) is
 * from the photograph's: 1 in the photograph's own light and pose. Smooth, so that an eye that turns does not flicker. */
float scene_own_light_share(const struct scene *scene, const float mean[3]);

/* The factor of own_light at (x, y) of the iris plane, mm, for such a share, to the power conf.detail; 1 where there is none. */
float scene_own_light_at(const struct scene *scene, float share, float x, float y);

#endif
