/* relief: fits the filter that sharpens the coarse thickness to the photograph, by rendering and comparing (iris paper, section 4,
 * figs. 6-7).
 *
 * The filter works on ln thickness: ln T' = base + sum_b (1 + gain_b) band_b, the bands differences of Gaussians. The
 * rendering is the forward model of tissue/tissue.h at every texel, times the darkening of hollows by their surroundings:
 *     ln L = ln R(T) + kappa (T - G T) / reach,  G a Gaussian of `reach`.
 * Both against Monte Carlo (tests/unit/tissue/test_relief.c): where scattering prevails, lateral spread and shading cancel and R(T)
 * alone is within 3 to 5 %; where melanin prevails, R hardly depends on T and the second term is what shows relief.
 */
#ifndef TISSUE_RELIEF_RELIEF_H
#define TISSUE_RELIEF_RELIEF_H
#include "tissue/pigment/pigment.h"

enum { RELIEF_BANDS = 3 };

struct relief_conf {
	double band[RELIEF_BANDS];  // mm: band b lies between Gaussians band[b-1] (none) and band[b]; ascending
	double relief_sigma;        // prior: rms of ln thickness about the coarse field, in each band
	double pitch;               // mm a texel of the fit
	double occlusion;           // times the kappa found by Monte Carlo
	double reach;               // mm
	double model_error;         // of ln luminance, 1 sigma, of texels that are independent
	double low, high;           // thickness stays between them, mm
	bool filter;                // false: gains stay 0, the paper's coarse height field
};

struct relief_fit {
	double gain[RELIEF_BANDS], gain_sigma[RELIEF_BANDS];
	double before, after;       // rms difference of ln luminance, detail only: coarse height field, filtered one
	double contrast;            // rms of the photograph's own detail: the residual of no relief at all
	double slope;               // d ln luminance / d ln thickness at the median thickness
	double kappa;
	int iterations;
};

/* Fits the gains.
 * clean      R, G, B, W; thickness: first channel mm; the same square grid of half-width extent mm
 * root       radius of the iris' root, mm
 * white, x   as in pigment_classify, pigment_solve
 * Returns false, err set, when too few texels were seen, or the fit fails. */
bool relief_solve(struct relief_fit *fit, const struct image *clean, const struct image *thickness, double extent,
                  const struct pupil *pupil, double root, const double white[3], const double x[PIGMENT_N],
                  const struct pigment_conf *pigment, const struct relief_conf *conf, struct err *err);

/* out: thickness after the filter, mm, one channel, new; image_free. */
bool relief_apply(struct image *out, const struct image *thickness, double extent, const struct relief_fit *fit,
                  const struct relief_conf *conf, struct err *err);

#endif
