/* likeness: two pictures of one thing by two programs: structure and outline. Linear RGBA of one size, A the cover. */
#ifndef TESTS_LIKENESS_H
#define TESTS_LIKENESS_H
#include "image/image.h"

/* Structural similarity (Wang, Bovik, Sheikh and Simoncelli 2004: Gaussian window of 1.5 px, K1 = 0.01, K2 = 0.03) of the light as sRGB codes it,
 * at an exposure, mean over the pixels that both cover. 1: the same.
 * half: null; or two pictures with independent noise, as a path tracer's of two seeds, of which b is the mean: the noise that their difference tells is
 * taken off b's variance, so that what is left is what b would be likened to with any number of samples. Noise does not go with a's structure: their covariance
 * stays as it is. */
double likeness_structure(const struct image *a, const struct image *b, const struct image *const half[2], double gain);

/* How far the outlines are apart, px: the area that only one of them covers, over the length of a's outline. 0 where there is no outline. */
double likeness_outline(const struct image *a, const struct image *b);

#endif
