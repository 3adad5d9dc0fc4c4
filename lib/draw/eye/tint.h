/* tint: what the map of melanin and the error of the photograph's white change the model's colour by; and that white. */
#ifndef DRAW_EYE_TINT_H
#define DRAW_EYE_TINT_H
#include "draw/eye/scene.h"

/* Fills scene->tint from pigment.json: the tissue's reflectance with the melanin of each node over that with the iris' own, of stroma as
 * thick as it is there, at the middle of ways through a cornea, times the error of white as fitted. The march takes the iris' own melanin; this
 * factor, which other ways through the thin border layer change little, is put on its colour. The relief and tissue must be loaded. Empty
 * where there are no pigments. Returns false, err set, when the file is damaged. */
bool scene_tint_make(struct scene *scene, const char *pigment, struct err *err);

/* The colour of white in the photographs over its green, by the sclera or a card, as measured; 1 where pigment.json does not
 * tell it, or is not there. False, err set, when the file is damaged. */
bool scene_white(double out[3], const char *pigment, struct err *err);

/* The factor at (x, y), mm; 1 where there is none. */
void scene_tint_at(float rgb[3], const struct scene *scene, float x, float y);

#endif
