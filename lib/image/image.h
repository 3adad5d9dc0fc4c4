/* image: pixels in memory, as float.
 * Row-major, channels interleaved, row 0 on top. Colour is linear Rec. 709 radiance.
 * Places are px, x right, y down; the centre of the first pixel is (0.5, 0.5).
 */
#ifndef IMAGE_IMAGE_H
#define IMAGE_IMAGE_H
#include <stdint.h>

#include "base/err.h"

struct image {
	int width, height, channels;
	float *px;  // [height][width][channels]; owned; 64-byte aligned
};

/* A zeroed image; the caller owns it: image_free. */
struct image image_new(int width, int height, int channels);

/* Accepts an empty image, and leaves one. */
void image_free(struct image *image);

/* The channels of the pixel in column x, row y, which must be inside. */
static inline float *image_at(const struct image *image, int x, int y)
{
	return image->px + ((long)y * image->width + x) * image->channels;
}

/* Value of one channel at (x, y) px, bilinear, clamped at the borders. */
float image_sample(const struct image *image, double x, double y, int channel);

/* sRGB transfer function and its inverse (IEC 61966-2-1), of one value. */
float srgb_from_linear(float linear);
float linear_from_srgb(float srgb);

/* 8-bit sRGB of a colour (3) or grey (1) image, values clamped to 0..1; [height][width][channels]; free(). */
uint8_t *image_to_srgb8(const struct image *image);

#endif
