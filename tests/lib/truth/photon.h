/* photon: light in a two-layer slab by Monte Carlo, all orders of scattering: the truth that the single-scattering fits
 * are held against. Shares no code and no formula of transport with lib/tissue.
 *
 * The slab stands on a black plane z = 0; the stroma reaches up to stroma[y][x] mm, the border layer `abl` mm beyond.
 * Periodic in x and y; indices matched; scattering by Henyey and Greenstein.
 */
#ifndef TESTS_PHOTON_H
#define TESTS_PHOTON_H
#include <stdbool.h>
#include <stdint.h>

struct photon_slab {
	int n;                // cells a side
	double cell;          // mm
	const float *stroma;  // [n][n] mm
	double abl;           // mm
	double scatter[2], absorb[2];  // border layer, stroma; mm^-1
	double g;             // mean cosine of scattering; 0: isotropic
	bool from_x;          // light comes from the side of +x alone, not from all azimuths
};

/* out[n][n]: pi times radiance straight up over irradiance on the plane z = 0 (a white Lambertian plane gives 1), for
 * light that comes from all azimuths (or slab->from_x) with that cosine. orders: 0 all, else no more than that many scatterings. */
void photon_reflectance(float *out, const struct photon_slab *slab, double cos_light, long photons, int orders,
                        uint64_t seed);

/* The standard deviation along an axis, mm, between where light of that cosine enters the plane and where it comes out straight up. The slab of
 * one cell. */
double photon_spread(const struct photon_slab *slab, double cos_light, long photons, uint64_t seed);

#endif
