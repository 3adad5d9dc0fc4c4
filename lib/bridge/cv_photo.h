/* cv_photo: pictures resampled by OpenCV. Reading and writing them is image/photo.h's and image/picture.h's. */
#ifndef BRIDGE_CV_PHOTO_H
#define BRIDGE_CV_PHOTO_H
#ifdef __cplusplus
extern "C" {
#endif
#include "image/photo.h"
#include "image/picture.h"

/* Area-averaged (smaller) or bicubic (larger) copy; free(). */
uint8_t *cv_resize8(const uint8_t *px, int width, int height, int channels, int new_width, int new_height);

/* Names of before, for callers not yet moved. */
#define cv_photo_load photo_load
#define cv_png_write picture_png_write
#define cv_png_write_linear picture_png_write_linear
#define cv_jpeg_encode picture_jpeg_encode
#define cv_rgb8_read picture_read

#ifdef __cplusplus
}
#endif
#endif
