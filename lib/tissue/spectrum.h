/* spectrum: light, observer and the three numbers a photograph keeps of a spectrum.
 * Spectra are sampled at SPECTRUM_N wavelengths, 380 to 780 nm in steps of 5.
 */
#ifndef TISSUE_SPECTRUM_H
#define TISSUE_SPECTRUM_H

enum { SPECTRUM_N = 81 };

/* Wavelength of sample i, nm. */
static inline double spectrum_nm(int i)
{
	return 380 + 5.0 * i;
}

enum illuminant { ILLUMINANT_D65, ILLUMINANT_D55, ILLUMINANT_D50, ILLUMINANT_A, ILLUMINANT_F2, ILLUMINANT_F11, ILLUMINANT_E };

/* "D65", "D55" (daylight, electronic flash), "D50", "A" (tungsten), "F2" (cool white fluorescent), "F11" (narrow-band
 * fluorescent), "E" (equal energy): null-terminated, in the order of the enum; for OPT_CHOICE. */
extern const char *const illuminant_names[];

/* Relative power of the illuminant at nm; its scale means nothing. Daylights from the CIE's components S0 to S2 (CIE 15),
 * A from its formula, F2 and F11 from the CIE's tables, linear between samples. */
double illuminant_power(enum illuminant light, double nm);

/* CIE 1931 2-degree colour matching functions: the multi-lobe fit of Wyman, Sloan and Shirley, JCGT 2(2), 2013. */
void observer_xyz(double xyz[3], double nm);

/* What a colorimetric camera that was balanced for the light makes of a reflectance: the weights of its integral,
 * rgb[c] = sum_i weight[c][i] reflectance[i], linear Rec. 709. White is adapted to D65 by Bradford's matrix; a perfect
 * white gives exactly (1, 1, 1). Weights may be negative: Rec. 709 does not hold all colours. */
struct observer {
	double weight[3][SPECTRUM_N];
};
void observer_make(struct observer *observer, enum illuminant light);

#endif
