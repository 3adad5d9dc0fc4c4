/* sclera_photons: the white of the eye under one distant lamp, by Monte Carlo of photons in a shell of tissue below a film of water, before black. It shares
 * nothing with the renderer: it knows refraction, Henyey and Greenstein's scattering and absorption, step by step. */
#ifndef PEERS_SCLERA_PHOTONS_H
#define PEERS_SCLERA_PHOTONS_H
#include <stdint.h>

struct sclera_shell {
	double radius, thickness;   // mm
	double scatter, absorb;     // reduced scattering coefficient, absorption, 1/mm
	double anisotropy;          // mean cosine of a scattering
	double index;
};

/* out[k]: light that leaves an area in zone k of n, equal steps of the angle from the lamp (0: where it stands overhead, pi), over the mean of the whole
 * sphere, which is what light that is the same from everywhere leaves. Returns the share of the photons that come out again. */
double sclera_photons(double out[], int n, const struct sclera_shell *shell, long photons, uint64_t seed);

#endif
