/* What the scalar and the vector solver of the light path share. */
#ifndef OPTICS_LIGHTPATH_START_H
#define OPTICS_LIGHTPATH_START_H
#include <float.h>
#include <math.h>

#include "optics/cornea.h"

/* How far the first guess bends the direction to the light towards the axis: 0.8 leaves 0.19 mm on average over
 * the hemisphere, and Newton one step less than 0.6 does. */
#define LIGHTPATH_BEND 0.8

/* The surface is continued a little past the rim, so that paths beyond it are found and named. */
static inline double lightpath_reach(const struct cornea *cornea)
{
	double equator = cornea->p > 0 ? cornea->R / sqrt(cornea->p) : DBL_MAX;
	return fmin(1.4 * cornea->rim, (1 - 1e-6) * equator);
}

#endif
