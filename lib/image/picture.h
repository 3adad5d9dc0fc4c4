/* picture: 8-bit sRGB pictures for people to look at, as PNG and JPEG.
 * Pixels are [height][width][channels], row 0 on top.
 */
#ifndef IMAGE_PICTURE_H
#define IMAGE_PICTURE_H
#include <stddef.h>
#include <stdint.h>

#include "image/image.h"

/* Writes a PNG file beside `path`, then renames it. channels: 1 grey, 3 RGB or 4 RGBA. False, err set, when it cannot. */
bool picture_png_write(const char *path, const uint8_t *px, int width, int height, int channels, struct err *err);

/* The same of image_to_srgb8(image). */
bool picture_png_write_linear(const char *path, const struct image *image, struct err *err);

/* Encodes a PNG in memory. data: owned by the caller, free(); channels as above. */
bool picture_png_encode(uint8_t **data, size_t *size, const uint8_t *px, int width, int height, int channels,
                        struct err *err);

/* Encodes a JPEG in memory, for pages that embed pictures. data: owned by the caller, free();
 * channels: 1, 3 or 4 (alpha is dropped); quality: 1..100. */
bool picture_jpeg_encode(uint8_t **data, size_t *size, const uint8_t *px, int width, int height, int channels,
                         int quality, struct err *err);

/* Reads any photograph that photo_load reads, upright, as 8-bit RGB. px: [height][width][3], free().
 * False, err set, as photo_load. Small: what photo_load_small makes of it. */
bool picture_read(uint8_t **px, int *width, int *height, const char *path, double limit_mpx, struct err *err);
bool picture_read_small(uint8_t **px, int *width, int *height, const char *path, int side, double limit_mpx, struct err *err);

#endif
