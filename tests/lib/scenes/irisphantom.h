/* irisphantom: a patch of iris of known relief and pigment, photographed by Monte Carlo (photon.h). */
#ifndef TESTS_IRISPHANTOM_H
#define TESTS_IRISPHANTOM_H
#include "tissue/tissue.h"
#include "image/image.h"

struct irisphantom {
	double extent;        // half-width, mm
	struct image truth;   // stroma, mm
	struct image clean;   // R, G, B, W: reflectance factor, linear Rec. 709, as seen from above
	struct image coarse;  // stroma as heightfield guesses it from the light: mm
};

/* Crypts and furrows of `rough` times the usual depth; n texels a side of 0.04 mm. cos_light: of a ring of light. gain:
 * of the coarse guess. photons: a wavelength; 3 wavelengths. */
struct irisphantom irisphantom_new(const struct tissue *tissue, int n, double rough, double cos_light, double gain,
                                   long photons, uint64_t seed);
void irisphantom_free(struct irisphantom *phantom);

/* Pearson correlation of ln a and ln b (first channels), and rms of ln a - ln b without its mean. */
double irisphantom_correlation(const struct image *a, const struct image *b, double *rms);

#endif
