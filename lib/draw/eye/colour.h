/* colour: the albedo step: what the photograph shows beyond the fitted model, carried over to other light and views. Equation in
 * fit_colour.c. */
#ifndef DRAW_EYE_COLOUR_H
#define DRAW_EYE_COLOUR_H
#include "draw/eye/batch_impl.h"
#include "draw/eye/march/beam.h"

#define SCENE_DARK 1e-4f  // lower bound of colours that are divided by each other

/* Turns the model's colour at the point (x, y) of the iris plane (mm) into the photograph's; rgb is both in and out. own: of the beams. */
void scene_colour(float rgb[3], const struct scene *scene, const struct scene_level *level, float x, float y, float own);

/* The same without the factor of the photograph's own colour, at n points: rgb in is the model's colour, rgb out the ratio to
 * what the model showed in the photograph. per_model: 1 over that, by channel. */
void scene_colour_ratio(int n, float rgb[3][BATCH], const struct scene *scene, const float *const per_model[3]);

/* The model's colour at n (at most BATCH) texels of row y, from column x0 on, seen through the cornea from a camera at C (eye's frame,
 * mm): fills b. */
void scene_model_row(struct iris_batch *b, const struct scene *scene, const struct scene_level *level, int x0, int n, int y,
                     const double C[3], const struct scene_beams *beams);

#endif
