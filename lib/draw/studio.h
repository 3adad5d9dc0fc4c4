/* studio: exposure and background of the beauty views. */
#ifndef DRAW_STUDIO_H
#define DRAW_STUDIO_H
#include "image/envmap/envmap.h"
#include "image/image.h"

/* The gain for the sclera of an eye that looks into the camera: midway between its mean and its brightest side it comes out at
 * 62 % of white. Within 0.05..3.
 * env     in the camera's frame
 * sclera  albedo, linear */
double studio_exposure(const struct envmap *env, const double sclera[3]);

/* A picture (RGB premultiplied and A) times gain on a photographer's grey, which falls off towards the corners, with that share of its light
 * scattered (bloom.h). image_free. */
struct image studio_on_grey(const struct image *rgba, double gain, double glow);

#endif
