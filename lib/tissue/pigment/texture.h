/* texture: squares of an iris' texels as reflectances, for classes and for the map of melanin. */
#ifndef TISSUE_PIGMENT_TEXTURE_H
#define TISSUE_PIGMENT_TEXTURE_H
#include "tissue/pigment/pigment.h"

struct pigment_texel {
	float thickness, share, rgb[3], key, x, y;  // mm; iris_share; reflectance and its luminance; place, mm
};

/* Those that were well seen and whose iris_share lies between inner and outer. n: out, how many; pitch: out, mm from one to the next.
 * free(). */
struct pigment_texel *pigment_texels(long *n, double *pitch, const struct pigment_texture *texture, double inner, double outer);

#endif
