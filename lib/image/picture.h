/* picture: 8-bit sRGB pictures in and out, for people to look at. [height][width][channels], row 0 on top. */
#ifndef IMAGE_PICTURE_H
#define IMAGE_PICTURE_H
#include <stddef.h>
#include <stdint.h>

#include "image/image.h"

/* PNG file; channels 1 grey, 3 RGB or 4 RGBA. Written beside and renamed. */
bool picture_png_write(const char *path, const uint8_t *px, int width, int height, int channels, struct err *err);

/* The same of image_to_srgb8(image). */
bool picture_png_write_linear(const char *path, const struct image *image, struct err *err);

/* PNG bytes in memory; free(). */
bool picture_png_encode(uint8_t **data, size_t *size, const uint8_t *px, int width, int height, int channels,
                        struct err *err);

/* JPEG bytes, for pages that embed pictures; channels 1, 3 or 4 (alpha dropped); quality 1..100; free(). */
bool picture_jpeg_encode(uint8_t **data, size_t *size, const uint8_t *px, int width, int height, int channels,
                         int quality, struct err *err);

/* Pixels of any photograph photo_load reads, upright, as 8-bit [height][width][3] RGB; free(). */
bool picture_read(uint8_t **px, int *width, int *height, const char *path, double limit_mpx, struct err *err);

#endif
