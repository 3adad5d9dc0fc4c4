/* levels: the iris maps in ever coarser resolutions. */
#ifndef DRAW_EYE_LEVELS_H
#define DRAW_EYE_LEVELS_H
#include "draw/eye/scene.h"

/* Levels below level 0, and the range of heights. */
void scene_levels_make(struct scene *scene);

/* Levels finer than that are not marched from. */
int scene_marched(const struct scene *scene);

/* The level whose texels are about as large as a pixel of `mm`. */
const struct scene_level *scene_level_for(const struct scene *scene, double mm);

#endif
