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

/* What a lens and a film make of a picture: shares, 0..1. */
struct studio_finish {
	double bloom;  // of its light that is scattered (bloom.h)
	double tone;   // of a film's curve for highlights (tone.h)
};

/* A picture (RGB premultiplied and A) times gain on a photographer's grey, which falls off towards the corners, finished. image_free. */
struct image studio_on_grey(const struct image *rgba, double gain, const struct studio_finish *finish);

#endif
