/* height: the height of the iris' anterior surface from its thickness. */
#ifndef TISSUE_RELIEF_HEIGHT_H
#define TISSUE_RELIEF_HEIGHT_H
#include "iris/heightfield/heightfield.h"

/* Height of the anterior surface against its mean over the iris: the iris' back is straight (Pavlin et al.), so what is
 * thicker stands higher. The border layer is of even thickness: no part of it.
 * out        new, 2 channels: height mm, thickness mm; image_free
 * thickness  mm, the first channel, square, of half-width extent mm
 * root       radius of the iris' root, mm
 * Returns the rms height over the iris, mm. The same bits for any number of threads. */
double relief_heights(struct image *out, const struct image *thickness, double extent, const struct pupil *pupil, double root);

#endif
