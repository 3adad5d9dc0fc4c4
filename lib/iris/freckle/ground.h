/* freckle_ground: what the iris looks like around each place. Internal. */
#ifndef IRIS_FRECKLE_GROUND_H
#define IRIS_FRECKLE_GROUND_H
#include <stdint.h>

#include "iris/unrefract/mask.h"

enum { GROUND_SECTORS = 24, GROUND_RINGS = 32 };

/* Median and spread of a plane in windows of three sectors by three rings. */
struct ground {
	float median[GROUND_SECTORS][GROUND_RINGS], spread[GROUND_SECTORS][GROUND_RINGS];
};

/* plane: [size][size] over the texels with use set; values between lo and hi. */
struct ground *ground_new(const float *plane, const uint8_t *use, const struct sheet *sheet, float lo, float hi);

/* Both, bilinear, at sheet coordinates t and phi. */
void ground_at(float *median, float *spread, const struct ground *ground, double t, double phi);

#endif
