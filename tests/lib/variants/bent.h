/* bent: pictures with lens distortion. Has formulas of its own and shares only structs with lib/: the programs are
 * tested against it.
 */
#ifndef TESTS_BENT_H
#define TESTS_BENT_H
#include <stdint.h>

#include "optics/camera.h"

/* Where the lens puts what a straight one would put at `straight`, px: OpenCV's documented polynomial. */
void bent_pixel(double bent[2], const struct camera *lens, const double straight[2]);

/* The inverse, by fixed-point steps. */
void bent_straight(double straight[2], const struct camera *lens, const double bent[2]);

/* in, out: [height][width][3]; bicubic; places the picture does not have repeat its border. */
void bent_rgb16(uint16_t *out, const uint16_t *in, int width, int height, const struct camera *lens);
void bent_rgb8(uint8_t *out, const uint8_t *in, int width, int height, const struct camera *lens);

#endif
