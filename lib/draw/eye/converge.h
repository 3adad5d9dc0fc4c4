/* converge: Monte Carlo over light and pixel: the reference that scene_render approaches. */
#ifndef DRAW_EYE_CONVERGE_H
#define DRAW_EYE_CONVERGE_H
#include "draw/eye/render.h"

/* The mean of `passes` pictures. Each draws the environment's `lights` directions anew within their regions, so that areas light
 * as areas, and its rays anew within their pixels.
 * env    in the camera's frame; mirror: as in struct scene_lighting
 * error  out, or null: mean relative standard error of the luminance
 * Returns as scene_render; image_free. */
struct image scene_converge(const struct scene *scene, const struct scene_view *view, const struct envmap *env,
                            const struct envmap *mirror, int lights, int passes, double *error, struct scene_count *count);

#endif
