/* spread: how far light travels sideways in the iris before it comes out again. Tissue in shadow is lit from beside. */
#ifndef TISSUE_SPREAD_H
#define TISSUE_SPREAD_H
#include "tissue/tissue.h"

/* The standard deviation along an axis of the iris plane, mm, between where light of one wavelength enters stroma of that thickness (anatomical
 * mm) and where it leaves. The mean way of the light that comes back, in each layer, is what its logarithm loses with that layer's absorption,
 * L = -d ln R / d absorption (R of all orders, tissue_reflectance_forward). Along ways whose lengths s are distributed as exp(-s / L) / L it
 * walks at random and persists over the transport mean free path l, the inverse of the reduced scattering coefficient (Fuerth 1920: along an
 * axis the mean square is (2/3) l^2 (s / l - 1 + exp(-s / l))):
 *     sigma^2 = sum over layers of (2/3) L^2 l / (l + L).
 * For long ways that is diffusion: sigma^2 = 2 D L with D = l / 3. Against Monte Carlo within 10 %, in dark tissue within 17 %
 * (tests/unit/tissue/test_tissue.c). That slanted light comes out a little further on than it went in, by 0.05 to 0.2 mm in the mean, is not in it.
 * Zero where the tissue scatters light once only, which stays where it is. */
double tissue_spread(const struct tissue *tissue, double nm, double stroma);

/* What light that spreads shows of a map: of fine detail half is smoothed by TISSUE_SPREAD_WIDE sigma, the rest by TISSUE_SPREAD_NARROW sigma.
 * Against Monte Carlo of relief under light from above, in tissues of 0.25 to 0.45 mm sigma (tests/unit/tissue/test_shading.c).
 * map   in and out: [n][n][channels], channels 1 to 4; mirrored beyond its borders. sigma: texels
 * Returns false, err set, where OpenCV fails. */
#define TISSUE_SPREAD_WIDE 0.8
#define TISSUE_SPREAD_NARROW 0.2
#define TISSUE_SPREAD_SHARE 0.55  // of wide
bool tissue_spread_map(float *map, int n, int channels, double sigma, struct err *err);

/* The wavelength to which eyes are most sensitive, nm: one spread for all colours; red light spreads by a fifth more, blue by a quarter less. Those of
 * each channel: the dominant wavelengths of Rec. 709's primaries. */
#define TISSUE_SPREAD_NM 555.0
#define TISSUE_PRIMARIES_NM { 611.0, 549.0, 464.0 }

#endif
