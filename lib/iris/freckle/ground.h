/* ground: local background statistics of an iris map. Internal to freckle. */
#ifndef IRIS_FRECKLE_GROUND_H
#define IRIS_FRECKLE_GROUND_H
#include <stdint.h>

#include "iris/unrefract/rings.h"

enum { GROUND_SECTORS = 24, GROUND_RINGS = 32 };

/* Median and spread of a plane in overlapping windows of three sectors by three rings of the sheet (rings.h). */
struct ground {
	float median[GROUND_SECTORS][GROUND_RINGS], spread[GROUND_SECTORS][GROUND_RINGS];
};

/* Statistics of a plane [size][size] over the texels with use set, from a histogram between lo and hi. free(). */
struct ground *ground_new(const float *plane, const uint8_t *use, const struct sheet *sheet, float lo, float hi);

/* Median and spread at sheet coordinates t and phi, bilinear. */
void ground_at(float *median, float *spread, const struct ground *ground, double t, double phi);

#endif
