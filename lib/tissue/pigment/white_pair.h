/* white_pair: the white of an eye by that of the other eye in the same photograph, too. */
#ifndef TISSUE_PIGMENT_WHITE_PAIR_H
#define TISSUE_PIGMENT_WHITE_PAIR_H

/* Colours as ln R/G, ln B/G. */
enum { CHROMA = 2 };

struct white_pair_conf {
	double sigma;    // of a white's colour where sclera alone was measured
	double skin[2];  // chance that skin is among it; mean of the ln by which it is redder, and less blue, then
	double light;    // scale by which the light differs between two eyes of a face
	double iris;     // scale by which fellow irises differ in colour
	double ring[2];  // part of the irises that is compared, of the limbus' radius
};

void chroma_of(double out[CHROMA], const double rgb[3]);

/* The colour of white at one eye from what was measured at both. Each is that of the light there, with noise, and perhaps with skin in it, which
 * is redder. The lights are mostly alike, as far as the irises do not say that they differ: both differences have Student's distribution
 * with two degrees of freedom, so that light that does differ is believed. The mean of the posterior, each channel ratio for itself.
 * own, fellow  as measured
 * iris         own iris' colour in the photograph less the other's; null: not known */
void white_pair(double out[CHROMA], const double own[CHROMA], const double fellow[CHROMA], const double *iris, const struct white_pair_conf *conf);

#endif
