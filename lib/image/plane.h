/* plane: single-channel maps, row-major [height][width], and what masks and textures need of them. */
#ifndef IMAGE_PLANE_H
#define IMAGE_PLANE_H
#include <stdint.h>

/* Gaussian blur in place, as three box blurs (error below 3 % of the peak); borders repeat. sigma px. */
void plane_blur(float *px, int width, int height, double sigma);

/* The same of px where weight says so: blur(px weight) / blur(weight); `fallback` where no weight reaches. */
void plane_blur_weighted(float *px, const float *weight, int width, int height, double sigma, float fallback);

/* Value at (x, y) px, centre of the first at (0.5, 0.5); bilinear, clamped at the borders. */
float plane_sample(const float *px, int width, int height, double x, double y);

/* Sets every pixel within `radius` px of a set one (chamfer distance 3-4, good to 6 %); a negative radius clears every
 * pixel within −radius of a clear one. */
void mask_grow(uint8_t *mask, int width, int height, double radius);

/* Numbers the 8-connected blobs of set pixels 1..n in order of their first pixel, row by row; 0 elsewhere.
 * Returns n. */
int mask_label(int *label, const uint8_t *mask, int width, int height);

#endif
