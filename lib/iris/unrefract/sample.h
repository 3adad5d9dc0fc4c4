/* unrefract_sample: the part of a photograph that shows the iris, in linear colour, and its texels. Internal. */
#ifndef IRIS_UNREFRACT_SAMPLE_H
#define IRIS_UNREFRACT_SAMPLE_H
#include "iris/unrefract/unrefract.h"

struct crop {
	struct image image;  // linear RGB, averaged over `step` photo pixels each way
	int x0, y0, step;    // photo px
};

/* What the map needs of the photograph, averaged down so that a texel covers about one pixel. */
struct crop crop_new(const struct photo *photo, const struct iris_map *map);
void crop_free(struct crop *crop);

/* rgb[size][size][3]: bicubic, zero where the map leads nowhere or out of the photograph, or skip (may be null) is
 * set. Returns how many texels were sampled. */
long crop_sample(float *rgb, const struct crop *crop, const struct iris_map *map, const uint8_t *skip);

/* Photo pixels that the texel spans in its most foreshortened direction; 0 where unknown. */
float map_resolution(const struct iris_map *map, int col, int row);

#endif
