/* make: what every scene is made with, whether its eye was fitted (load.c) or invented (plain.c): surfaces and tissue. */
#ifndef DRAW_EYE_MAKE_H
#define DRAW_EYE_MAKE_H
#include "draw/eye/scene.h"

/* Sets cornea, limbus and sclera from scene->eye and conf. */
void scene_geometry(struct scene *scene);

/* The stroma's thickness (mm) and a tissue for an eye where none was fitted. */
extern const double scene_plain_stroma;
extern const struct tissue scene_plain_tissue;

/* Sets the tissue, its optics in conf.bands wavelengths, and its mean colour. */
void scene_set_tissue(struct scene *scene, const struct tissue *tissue);

/* Sets scene->rim for its limbus, its tissue and its thickness there. */
void scene_rim_make(struct scene *scene);

/* Depths of the two planes between which all of the iris lies, mm: above the highest relief, below the deepest epithelium. */
void scene_planes(double z[2], const struct scene *scene);

#endif
