/* pupil: the margin of the pupil and its ruff. */
#ifndef DRAW_EYE_PUPIL_H
#define DRAW_EYE_PUPIL_H
#include "draw/eye/scene.h"

/* Factor of the iris' colour, by channel, at the point (x, y) of the iris plane (mm): 0 inside the pupil, less than 1 on the
 * dark ruff. soft: half a pixel, mm, over which the margin is blurred. */
void scene_pupil(float cover[3], const struct scene *scene, float x, float y, float soft);

#endif
