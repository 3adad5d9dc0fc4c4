/* sample: the part of a photograph that shows the iris, in linear colour, resampled into an iris map. Internal to unrefract. */
#ifndef IRIS_UNREFRACT_SAMPLE_H
#define IRIS_UNREFRACT_SAMPLE_H
#include "iris/unrefract/unrefract.h"

struct crop {
	struct image image;  // linear RGB, averaged over `step` photo pixels each way; owned
	int x0, y0, step;    // corner and step, photo px
};

/* The part of the photograph that the map reads, averaged down so that a texel covers about one pixel. crop_free. */
struct crop crop_new(const struct photo *photo, const struct iris_map *map);
void crop_free(struct crop *crop);

/* Samples the map's texels by bicubic interpolation.
 * rgb   [size][size][3], out; 0 where the map leads nowhere or out of the photograph, or skip is set
 * skip  [size][size], or null
 * Returns how many texels were sampled. */
long crop_sample(float *rgb, const struct crop *crop, const struct iris_map *map, const uint8_t *skip);

/* Photo pixels that a texel spans in its most foreshortened direction; 0 where unknown. */
float map_resolution(const struct iris_map *map, int col, int row);

#endif
