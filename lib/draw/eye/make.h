/* make: what every scene is made with, whether its eye was fitted or invented: surfaces and tissue. */
#ifndef DRAW_EYE_MAKE_H
#define DRAW_EYE_MAKE_H
#include "draw/eye/scene.h"

/* Limbus, sclera and cornea of s->eye. */
void scene_geometry(struct scene *scene);

/* Where nothing was fitted: the stroma's thickness, mm, and a tissue without melanin to speak of, as in a blue eye. */
extern const double scene_plain_stroma;
extern const struct tissue scene_plain_tissue;

/* Takes a tissue: its optics in the bands of s->conf, and its mean colour. */
void scene_set_tissue(struct scene *scene, const struct tissue *tissue);

/* Depths of the planes between which all of the iris lies, mm. */
void scene_planes(double z[2], const struct scene *scene);

#endif
