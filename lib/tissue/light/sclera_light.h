/* sclera_light: the light of a photograph from its sclera's shading. */
#ifndef TISSUE_LIGHT_SCLERA_LIGHT_H
#define TISSUE_LIGHT_SCLERA_LIGHT_H
#include "image/envmap/envmap.h"
#include "tissue/light/pale.h"

/* How the sclera's irradiance changes over its normal n in the camera's frame: E(n) ~ 1 + slope[0] n_x + slope[1] n_y. */
struct sclera_light {
	double slope[2], sigma[2];  // sigma: with the prior of 0.3 that an even light stands for
	double spread;              // of the samples about it, ln
};

/* Robust least squares over n samples of pale_find (Huber); few samples leave an even light. */
struct sclera_light sclera_light_fit(const struct pale samples[], int n);

/* Luminance of a white surface of that normal under the environment, lights summed one by one: exact where spherical harmonics ring. */
void sclera_light_at(float rgb[3], const struct envmap_light lights[], int n, const float normal[3]);

/* An environment of that shading and level 1: an even half before the face, and one broad lamp. How far the lamp stands from the camera's
 * axis the sclera's two sides do not tell: 37 degrees, more where the shading asks for it.
 * height  rows of the map. envmap_free. */
struct envmap sclera_light_environment(const struct sclera_light *light, int height);

#endif
