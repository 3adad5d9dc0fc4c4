/* colour: what the photograph shows beyond the fitted model, carried over to other light and views (the albedo step). */
#ifndef DRAW_EYE_COLOUR_H
#define DRAW_EYE_COLOUR_H
#include "draw/eye/batch_impl.h"

#define SCENE_DARK 1e-4f  // colours are at least that, so that their ratios are numbers

/* The model's colour at a point of the iris (in) made the photograph's (out). */
void scene_colour(float rgb[3], const struct scene *scene, const struct scene_level *level, float x, float y);

/* What that is without the photograph's colour, at n points. per_model: 1 over what the model showed there, by channel. */
void scene_colour_ratio(int n, float rgb[3][BATCH], const struct scene *scene, const float *const per_model[3]);

#endif
