/* patch: the mean colour of a small square of a photograph. */
#ifndef IMAGE_PHOTO_PATCH_H
#define IMAGE_PHOTO_PATCH_H
#include "image/photo/photo.h"

/* Mean of a square of 2 radius + 1 px about (x, y), linear. False outside of the photograph or where clipped. */
bool photo_patch(double rgb[3], const struct photo *photo, double x, double y, double radius);

#endif
