/* tissue: optical model of the iris, shared by the fit and the renderer: an anterior border layer (ABL) over the stroma over a
 * pigment epithelium that absorbs everything (iris paper section 4, eqs. 10-14; single scattering, section 5.3).
 *
 * Scattering. Eq. 14 is a REDUCED coefficient in its source (tissue optics). First order, the paper's, takes it with an ISOTROPIC phase
 * function, 1 / (4 pi): TISSUE_PHASE; all orders take the forward scattering that it was reduced from, TISSUE_ANISOTROPY. Both layers
 * scatter by it. It stands in the extinction too.
 * Indices. The aqueous and the tissue are matched: no Fresnel term at the iris (paper, section 5.3).
 * Thickness. Maps hold anatomical mm. The stroma is loose: `thickness_scale` says how much of each mm counts, and is
 * multiplied into the stroma's coefficients by tissue_optics_make, so that a march through the relief takes plain mm.
 *
 * Orders. With `multiple` set, extinction and source of tissue_optics_make are EFFECTIVE ones: the same first-order march
 * then returns, for thicknesses to 0.9 mm, the reflectance of all orders of scattering, as adding and doubling gives it
 * (forward.c), to 2 % in the mean; in dark tissue, far from the middle of angles, to 10 %. Without it, the paper's first order.
 *
 * To march a ray (in each band k; t from the surface, straight lines as in the aqueous):
 *     L[k] = integral of optics.source[layer][k] TISSUE_PHASE E[k] exp(-tau_view - tau_light) dt
 * with tau the integrals of optics.extinction[layer][k] along the path, E the irradiance on a plane that faces the light
 * inside the eye; then rgb[c] = light_rgb[c] * optics.exposure * sum_k optics.rgb[k][c] L[k] for light of one colour.
 * tissue_reflectance() is that march in closed form for parallel layers.
 */
#ifndef TISSUE_TISSUE_H
#define TISSUE_TISSUE_H
#include "base/err.h"
#include "tissue/spectrum.h"

#define TISSUE_PHASE 0.07957747154594767  // 1 / (4 pi)

/* Mean cosine of scattering in soft tissue: 0.8 to 0.95, dermis and sclera 0.9 (Jacques, Phys. Med. Biol. 58, 2013, R37). From 0.8 to
 * 0.95 the reflectance of irises at given reduced coefficients changes by a few per cent; isotropic scattering reflects up to three times
 * as much where much is absorbed. */
#define TISSUE_ANISOTROPY 0.9

enum { TISSUE_BANDS_MAX = 8 };
enum { TISSUE_ABL, TISSUE_STROMA, TISSUE_LAYERS };

struct tissue_layer {
	double melanin;          // C_m, volume fraction of melanin, 0..1
	double eumelanin_ratio;  // beta_m, share of eumelanin in it, 0..1
};

struct tissue {
	struct tissue_layer layer[TISSUE_LAYERS];
	double abl_thickness;       // mm
	double thickness_scale;     // of the stroma
	double exposure;            // photograph over model: the light, multiple scattering
	bool multiple;              // all orders of scattering, not only the first
	enum illuminant illuminant; // that the photograph was balanced for
};

/* Eqs. 10-13, mm^-1 at nm; eq. 14, reduced, mm^-1. */
double tissue_absorption(const struct tissue_layer *layer, double nm);
double tissue_scattering(double nm);

/* A few wavelengths that stand for the whole spectrum: linear Rec. 709 of a smooth reflectance is
 * sum_k rgb[k][c] reflectance(nm[k]). Nodes of Chebyshev, weights from the interpolating polynomial under the observer;
 * the reflectances of this tissue are so smooth that, against the full integral,
 * 3 bands are within 0.5 % (of the brightest channel), 4 within 0.06 %, 6 within 0.02 % (tests/unit/tissue/test_tissue.c). */
struct tissue_bands {
	int n;
	double nm[TISSUE_BANDS_MAX], rgb[TISSUE_BANDS_MAX][3];
};
void tissue_bands_make(struct tissue_bands *bands, int n, enum illuminant light);

/* Coefficients of both layers in every band, mm^-1 of anatomical thickness. */
struct tissue_optics {
	int n;
	double extinction[TISSUE_LAYERS][TISSUE_BANDS_MAX], source[TISSUE_LAYERS][TISSUE_BANDS_MAX];
	double rgb[TISSUE_BANDS_MAX][3];  // as in the bands
	double abl_thickness;             // mm
	double exposure;
};
void tissue_optics_make(struct tissue_optics *optics, const struct tissue *tissue, const struct tissue_bands *bands);

/* Layers whose scattering of all orders has been reckoned, most of the work of tissue_optics_make: for fits, which change one layer at a time.
 * Begins with n = 0; a smaller n forgets the last ones. One memo for one pair of cosines. */
enum { TISSUE_NODES = 7, TISSUE_MEMO_MAX = 2 * TISSUE_BANDS_MAX * 9 };
struct tissue_memo {
	int n;
	struct tissue_doubled { double source, absorb, r[TISSUE_NODES][TISSUE_NODES], t[TISSUE_NODES][TISSUE_NODES]; } of[TISSUE_MEMO_MAX];
};

/* The same bits, with a memo. */
void tissue_optics_make_again(struct tissue_optics *optics, const struct tissue *tissue, const struct tissue_bands *bands, struct tissue_memo *memo);

/* pi times radiance towards the camera over irradiance on the iris plane, first-order scattering, linear
 * Rec. 709 under white light; exposure not multiplied in. A white Lambertian surface would be 1; isotropic single
 * scattering without absorption is at most 1 / (4 (cos_view + cos_light)). stroma: anatomical mm; cosines in (0, 1]. */
void tissue_reflectance(double rgb[3], const struct tissue_optics *optics, double stroma, double cos_view,
                        double cos_light);

/* First order at one wavelength; arguments as below. */
double tissue_reflectance_one(const double extinction[TISSUE_LAYERS], const double source[TISSUE_LAYERS], double abl,
                              double stroma, double cos_view, double cos_light);

/* All orders, one wavelength, with the phase function of Henyey and Greenstein of anisotropy TISSUE_ANISOTROPY, whose reduced
 * coefficients source and extinction are: stroma of no thickness, of `stroma` mm and of twice that, in out. Against Monte Carlo to 2 %
 * (tests/unit/tissue/test_tissue.c). memo: or null. */
void tissue_reflectance_forward(double out[3], const double extinction[TISSUE_LAYERS], const double source[TISSUE_LAYERS], double abl,
                                double stroma, double cos_view, double cos_light, struct tissue_memo *memo);

/* Reads work/iris/pigment.json. Returns false, err set, when a number is missing or out of range. */
bool tissue_load(struct tissue *tissue, const char *path, struct err *err);

/* Whether the file says that there are no pigments, and why: "without" (pigment_save_none). */
bool tissue_without(char reason[256], const char *path);

#endif
