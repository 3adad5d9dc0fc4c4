/* cv_photo: 8-bit pictures resampled by OpenCV. They are read in image/photo/photo.h and written in image/picture.h. */
#ifndef BRIDGE_CV_PHOTO_H
#define BRIDGE_CV_PHOTO_H
#ifdef __cplusplus
extern "C" {
#endif
#include "image/photo/photo.h"
#include "image/picture.h"

/* A copy of px[height][width][channels] of another size, area-averaged (smaller) or bicubic (larger); free(). */
uint8_t *cv_resize8(const uint8_t *px, int width, int height, int channels, int new_width, int new_height);

#ifdef __cplusplus
}
#endif
#endif
