/* sclera: the white of the eye: its vessels and the ripples of its tear film. Its maps are azimuthal equidistant about the eye's
 * axis: the radius in the map is the angle at the centre of the scleral sphere. */
#ifndef DRAW_EYE_SCLERA_H
#define DRAW_EYE_SCLERA_H
#include <math.h>

#include "draw/eye/scene.h"

/* Angle at the edge of the maps, rad. */
#define SCENE_SCLERA_REACH (110 * M_PI / 180)

/* A vessel of the conjunctiva: how deep it lies and how wide it is, mm; the share of its blood's oxygen. */
#define SCENE_CONJUNCTIVA_MM 0.05
#define SCENE_VESSEL_MM 0.04
#define SCENE_OXYGEN 0.95

/* Fills veins, white and film of the scene, from conf.seed. */
void scene_veins_make(struct scene *scene);

/* Share of the sclera's light, by channel, that is left over a vessel of that depth and width (mm) and oxygen saturation (0..1).
 * Of the light that comes back from below the vessel (diffusion without absorption: 1 / (1 + 3/4 mu_s' depth)) the blood
 * absorbs on two paths through a cylinder. */
void scene_vessel(float left[3], double depth, double width, double oxygen);

/* Albedo at a point of the sclera (eye's frame, mm). normal: unit, in and out: bent by the film's ripples. */
void scene_sclera(float albedo[3], float normal[3], const struct scene *scene, const float point[3]);

#endif
