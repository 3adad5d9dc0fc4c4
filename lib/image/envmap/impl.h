/* What the files of envmap share. */
#ifndef IMAGE_ENVMAP_IMPL_H
#define IMAGE_ENVMAP_IMPL_H
#include "image/envmap/envmap.h"

/* latlong.c: unit direction of a place in the map, u (across) and v (down) 0..1. */
void envmap_dir(double dir[3], double u, double v);

/* latlong.c: the map averaged down to `rows` rows at most. image_free. */
struct image envmap_coarse(const struct image *map, int rows);

/* Rows of the coarse map that irradiance and lights are computed from. */
enum { ENVMAP_ROWS = 64 };

/* latlong.c: solid angle of a pixel in row y, sr. */
double envmap_solid_angle(const struct image *map, int y);

/* at.c: fills sharp, rough and bend from the map. */
void envmap_unfold(struct envmap *env);

#endif
