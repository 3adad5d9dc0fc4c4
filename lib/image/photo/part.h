/* part: part of a photograph at another scale.
 * px of the photograph, centre of its first pixel at (0.5, 0.5); what lies beyond its border repeats it.
 */
#ifndef IMAGE_PHOTO_PART_H
#define IMAGE_PHOTO_PART_H
#include "image/photo/photo.h"

/* The part whose corner is (x0, y0), `scale` px of the photograph in one of the result's: [3][height][width], encoded values 0..1; free().
 * A pixel is the mean of the square of `scale` px that it covers; of one px, that is bilinear, where scale is below 1. */
float *photo_part(const struct photo *photo, double x0, double y0, double scale, int width, int height);

/* The whole photograph, reduced by photo_part's rule to at most long_px on its longer side; *scale, >= 1: px of the photograph in one
 * of the result's, which are squares from (0, 0) on. 8 or 16 bits are kept in rgb alone. photo_free. */
struct photo photo_reduced(const struct photo *photo, int long_px, double *scale);

#endif
