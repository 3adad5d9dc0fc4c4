/* cv_photo: photographs in, pictures out, through OpenCV. */
#ifndef BRIDGE_CV_PHOTO_H
#define BRIDGE_CV_PHOTO_H
#ifdef __cplusplus
extern "C" {
#endif
#include "image/photo.h"

/* Reads, checks (photo_header) and decodes; EXIF orientation applied. photo_free. */
bool cv_photo_load(struct photo *photo, const char *path, double limit_mpx, struct err *err);

/* 8-bit PNG of [height][width][channels] sRGB pixels; channels 1, 3 or 4. Written beside and renamed. */
bool cv_png_write(const char *path, const uint8_t *px, int width, int height, int channels, struct err *err);

/* The same as cv_png_write of image_to_srgb8. */
bool cv_png_write_linear(const char *path, const struct image *image, struct err *err);

/* JPEG bytes of sRGB pixels, for pages that embed pictures; free(). */
bool cv_jpeg_encode(uint8_t **data, size_t *size, const uint8_t *px, int width, int height, int channels,
                    int quality, struct err *err);

/* Pixels of a PNG or JPEG file as 8-bit [height][width][3] RGB; free(). */
bool cv_rgb8_read(uint8_t **px, int *width, int *height, const char *path, double limit_mpx, struct err *err);

/* Area-averaged (smaller) or bicubic (larger) copy; free(). */
uint8_t *cv_resize8(const uint8_t *px, int width, int height, int channels, int new_width, int new_height);

#ifdef __cplusplus
}
#endif
#endif
