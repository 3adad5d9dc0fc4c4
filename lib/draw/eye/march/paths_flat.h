/* paths_flat: the light on a flat iris, without a march. */
#ifndef DRAW_EYE_MARCH_PATHS_FLAT_H
#define DRAW_EYE_MARCH_PATHS_FLAT_H
#include "draw/eye/march/paths.h"

/* Returns [SCENE_FLAT][SCENE_FLAT][4] over the square of the maps (texel centres half a step from its edge): the model's mean
 * colour times the irradiance of the iris plane; free(). Needs scene->paths. */
float *scene_paths_flat(const struct scene *scene, const struct scene_lighting *light, const double eye_from_cam[3][3]);

#endif
