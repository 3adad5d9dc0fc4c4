/* envmap_impl: what the files of the environment map share. */
#ifndef IMAGE_ENVMAP_IMPL_H
#define IMAGE_ENVMAP_IMPL_H
#include "image/envmap/envmap.h"

/* Direction of a place in the map, u and v 0..1. */
void envmap_dir(double dir[3], double u, double v);

/* The map averaged down to that many rows at most. image_free. */
struct image envmap_coarse(const struct image *map, int rows);

/* Sharp enough for the light that falls on a surface. */
enum { ENVMAP_ROWS = 64 };

/* Of a pixel in row y. */
double envmap_solid_angle(const struct image *map, int y);

/* Fills sharp and rough from the map. */
void envmap_unfold(struct envmap *env);

#endif
