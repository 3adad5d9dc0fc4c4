/* search: an iris map as searched for freckles: reduced in size, in logarithms, against its surroundings. Internal to freckle. */
#ifndef IRIS_FRECKLE_SEARCH_H
#define IRIS_FRECKLE_SEARCH_H
#include "iris/freckle/freckle.h"
#include "iris/unrefract/rings.h"

/* Planes are [size][size]; owned by freckles_find. */
struct search {
	int size, step;       // texels a side; texels of the full map each way
	double mm;            // a texel
	struct sheet sheet;
	uint8_t *use;         // 1: iris with weight, away from pupil and limbus
	float *log[3];        // of the colour, blurred
	float brown;          // median of log(red / green) over the iris
	float *ratio;         // rise of log(red / green)
	float *ratio_z;       // the same in the surroundings' spread
	float *fall[2];       // of log(red), log(green): negative where darker
};

#endif
