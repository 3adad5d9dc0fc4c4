/* pupil: the margin of the pupil and its ruff. */
#ifndef DRAW_EYE_PUPIL_H
#define DRAW_EYE_PUPIL_H
#include "draw/eye/scene.h"

/* What is seen of the iris' colour at a point near the pupil's margin: none inside, less on the ruff. soft: half a pixel, mm. */
void scene_pupil(float cover[3], const struct scene *scene, float x, float y, float soft);

#endif
