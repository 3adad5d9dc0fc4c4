/* shade: the iris as one view shows it, marched from the texels of its map instead of along every ray of sight. */
#ifndef DRAW_EYE_MARCH_SHADE_H
#define DRAW_EYE_MARCH_SHADE_H
#include "draw/eye/march/beam.h"

/* Colour of the iris at a point: detail times light, both bilinear. */
struct scene_shade {
	int light_n, light_stride;
	float per_mm, light_per_mm;  // texels in a mm: of detail, of light
	const struct scene_texels *detail;  // borrowed from the scene: what the photograph shows and the march does not
	float *light;                // [light_n][light_stride][4]: the march from these texels; owned
	bool even;                   // light is that of a flat iris: smooth
};

/* The march for a camera at C (eye's frame, mm) whose pixels are about as large as the texels of level. free(shade.light). */
struct scene_shade scene_shade_make(const struct scene *scene, const struct scene_level *level, const double C[3], const struct scene_beams *beams);

/* The cheap alternative: light of a flat iris on the photograph's colours, without beams. Needs scene->paths. free(shade.light). */
struct scene_shade scene_shade_flat(const struct scene *scene, const struct scene_level *level, const struct scene_lighting *light, const double eye_from_cam[3][3]);

/* Fills the level's model with the march from its own texels, times through: the denominator of later marches. */
void scene_shade_model(struct scene_level *level, const struct scene *scene, const double C[3], const struct scene_beams *beams, float through);

#endif
