/* sclera: the white of the eye: its vessels and the ripples of its tear film. */
#ifndef DRAW_EYE_SCLERA_H
#define DRAW_EYE_SCLERA_H
#include <math.h>

#include "draw/eye/scene.h"

/* Maps of the sclera are azimuthal and equidistant about the axis: angle at the sphere's centre at their edge. */
#define SCENE_SCLERA_REACH (110 * M_PI / 180)
void scene_veins_make(struct scene *scene);

/* What a vessel that lies so deep in the tissue leaves of its light: of what comes back from beyond that depth (diffusion without
 * absorption: 1 / (1 + 3/4 mu_s' depth)) its blood takes what it absorbs on two ways through a cylinder. mm; oxygen 0..1. */
void scene_vessel(float left[3], double depth, double width, double oxygen);

/* Albedo of the sclera and the ripple of its film at a point of it. */
void scene_sclera(float albedo[3], float normal[3], const struct scene *scene, const float point[3]);

#endif
