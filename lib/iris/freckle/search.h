/* freckle_search: an iris map as searched for freckles. Internal. */
#ifndef IRIS_FRECKLE_SEARCH_H
#define IRIS_FRECKLE_SEARCH_H
#include "iris/freckle/freckle.h"
#include "iris/unrefract/mask.h"

/* The map as searched: reduced, in logarithms, against its surroundings. */
struct search {
	int size, step;       // texels a side; texels of the full map each way
	double mm;            // a texel
	struct sheet sheet;
	uint8_t *use;
	float *log[3];        // of the colour, blurred
	float brown;          // median of log(red / green) over the iris
	float *ratio;         // rise of log(red / green)
	float *ratio_z;       // the same in the surroundings' spread
	float *fall[2];       // of log(red), log(green): negative where darker
};

/* Flat dark patches of a brown iris, which hide its fibres: fills out->items and marks them in opacity
 * [s->size][s->size], zeroed. */
void freckles_find_flat(struct freckles *out, float *opacity, const struct search *s, const struct freckle_conf *conf);

#endif
