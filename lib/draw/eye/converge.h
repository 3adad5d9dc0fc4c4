/* converge: the converging picture of an eye, by Monte Carlo over light and pixel: what quick pictures approach. */
#ifndef DRAW_EYE_CONVERGE_H
#define DRAW_EYE_CONVERGE_H
#include "draw/eye/render.h"

/* The mean of `passes`, each with the environment's `lights` directions drawn anew within their
 * regions (so that areas light as areas) and its rays drawn anew within their pixels. env stands in the camera's frame; mirror
 * as in the lighting. *error: mean relative standard error of the luminance of what is not black; null: not wanted. image_free. */
struct image scene_converge(const struct scene *scene, const struct scene_view *view, const struct envmap *env,
                            const struct envmap *mirror, int lights, int passes, double *error, struct scene_count *count);

#endif
