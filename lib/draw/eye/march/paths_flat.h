/* paths_flat: the light on a flat iris, without a march. */
#ifndef DRAW_EYE_MARCH_PATHS_FLAT_H
#define DRAW_EYE_MARCH_PATHS_FLAT_H
#include "draw/eye/march/paths.h"

/* Colour of a flat iris under these lights, [SCENE_FLAT][SCENE_FLAT][4] over the square of the maps, texels' centres half a step from
 * its edge: the model's mean colour times the irradiance of the iris plane. free(). The scene has paths. */
float *scene_paths_flat(const struct scene *scene, const struct scene_lighting *light, const double eye_from_cam[3][3]);

#endif
