/* tint: what the map of melanin and the error of the photograph's white change the model's colour by; and that white. */
#ifndef DRAW_EYE_TINT_H
#define DRAW_EYE_TINT_H
#include "draw/eye/scene.h"

/* Fills scene->tint from pigment.json: the tissue's reflectance with the melanin of each node over that with the iris' own, of stroma as
 * thick as it is there, at the middle of ways through a cornea, times the error of white as fitted. The march takes the iris' own melanin; this
 * factor, which other ways through the thin border layer change little, is put on its colour. The relief and tissue must be loaded. Empty
 * where there are no pigments. Returns false, err set, when the file is damaged. */
bool scene_tint_make(struct scene *scene, const char *pigment, struct err *err);

/* What white that faces the camera shows in the photographs, by the sclera or a card, as bright as the light on the eye makes it: the colour of that light and the
 * photograph's exposure; and the albedo of the sclera beside the limbus, at most 0.95. */
struct scene_white {
	double rgb[3], sclera[3];
	double error[3];  // what of rgb the iris' own colours have added to the white as measured, factors
	bool found, told, has_sclera;  // pigment.json has a white; it is from sclera or card, not the camera's own
};

/* 1, and no sclera, where pigment.json does not tell them, or is not there. False, err set, when the file is damaged. */
bool scene_white(struct scene_white *out, const char *pigment, struct err *err);

/* The factor at (x, y), mm; 1 where there is none. */
void scene_tint_at(float rgb[3], const struct scene *scene, float x, float y);

#endif
