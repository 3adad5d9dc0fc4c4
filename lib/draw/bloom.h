/* bloom: light that a lens, a sensor's cover and the reader's own eye scatter over a picture, so that bright light glows. */
#ifndef DRAW_BLOOM_H
#define DRAW_BLOOM_H
#include "image/image.h"

/* Moves a share of every pixel's light onto its surroundings, in place.
 * Scattered light falls with about the square of the distance (glare of the eye: Vos 1984; Spencer and others 1995, their f2; of lenses: Talvala and others 2007), so that every
 * octave of distances gets as much: from 1/256 of the picture's shorter side to an eighth of it, whatever the picture's size.
 * Light stays as much as it is, but for what is scattered across the borders, where the border's pixels are repeated.
 * rgb    linear
 * share  0..1; 0 leaves the picture as it is
 * The same steps as in render/viewer/bloom.frag. */
void bloom(struct image *rgb, double share);

#endif
