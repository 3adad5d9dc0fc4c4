/* cv_photo: pictures resampled by OpenCV. Reading and writing them is image/photo/photo.h's and image/picture.h's. */
#ifndef BRIDGE_CV_PHOTO_H
#define BRIDGE_CV_PHOTO_H
#ifdef __cplusplus
extern "C" {
#endif
#include "image/photo/photo.h"
#include "image/picture.h"

/* Area-averaged (smaller) or bicubic (larger) copy; free(). */
uint8_t *cv_resize8(const uint8_t *px, int width, int height, int channels, int new_width, int new_height);

#ifdef __cplusplus
}
#endif
#endif
