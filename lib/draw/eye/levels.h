/* levels: the mipmap pyramid of the iris maps. Level 0 is the finest; each further one averages 2 x 2 texels. */
#ifndef DRAW_EYE_LEVELS_H
#define DRAW_EYE_LEVELS_H
#include "draw/eye/scene.h"

/* Makes all levels below level 0 anew, and what quick pictures look up of each (conf.shading); sets the range of heights and
 * thicknesses. */
void scene_levels_make(struct scene *scene);

/* Index of the finest level that quick pictures march from. */
int scene_marched(const struct scene *scene);

/* The level whose texels are about as large as a pixel of mm on the iris. */
const struct scene_level *scene_level_for(const struct scene *scene, double mm);

#endif
