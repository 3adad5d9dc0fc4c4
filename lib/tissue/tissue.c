#include "tissue/tissue.h"

#include <assert.h>
#include <math.h>

/* Eqs. 10, 11 and 12: eumelanin, pheomelanin, baseline. */
double tissue_absorption(const struct tissue_layer *layer, double nm)
{
	double eumelanin = 6.6e10 * pow(nm, -3.33);
	double pheomelanin = 2.9e14 * pow(nm, -4.75);
	double baseline = 0.0244 + 8.53 * exp(-(nm - 154) / 66.2);
	double c = layer->melanin, b = layer->eumelanin_ratio;
	return c * (b * eumelanin + (1 - b) * pheomelanin) + (1 - c) * baseline;  // eq. 13
}

double tissue_scattering(double nm)
{
	return 14.74 * pow(nm, -0.22) + 2.2e11 * pow(nm, -4);  // eq. 14
}

/* Where the nodes lie decides the error: the range is narrower than the observer's, most for few bands; wavelength itself
 * suits three nodes, wavenumber more. Found by trying ranges on random tissues. */
static void nodes(int n, double nm[])
{
	double low = n <= 4 ? 430 : 410, high = n <= 4 ? 640 : 690;
	if (n > 3) {
		low = 1 / low;
		high = 1 / high;
	}
	for (int k = 0; k < n; k++) {
		double x = (low + high) / 2 - (high - low) / 2 * cos((2 * k + 1) * M_PI / (2 * n));
		nm[k] = n > 3 ? 1 / x : x;
	}
}

void tissue_bands_make(struct tissue_bands *bands, int n, enum illuminant light)
{
	assert(n >= 3 && n <= TISSUE_BANDS_MAX);
	struct observer observer;
	observer_make(&observer, light);
	*bands = (struct tissue_bands) { .n = n };
	nodes(n, bands->nm);
	for (int i = 0; i < SPECTRUM_N; i++) {
		double x = n > 3 ? 1 / spectrum_nm(i) : spectrum_nm(i);
		for (int k = 0; k < n; k++) {
			double xk = n > 3 ? 1 / bands->nm[k] : bands->nm[k], lagrange = 1;
			for (int j = 0; j < n; j++) {
				double xj = n > 3 ? 1 / bands->nm[j] : bands->nm[j];
				if (j != k)
					lagrange *= (x - xj) / (xk - xj);
			}
			for (int c = 0; c < 3; c++)
				bands->rgb[k][c] += observer.weight[c][i] * lagrange;
		}
	}
}

static void coefficients(double extinction[TISSUE_LAYERS], double source[TISSUE_LAYERS], const struct tissue *t, double nm)
{
	double scatter = tissue_scattering(nm);
	for (int l = 0; l < TISSUE_LAYERS; l++) {
		double scale = l == TISSUE_STROMA ? t->thickness_scale : 1;
		source[l] = scale * scatter;
		extinction[l] = scale * (scatter + tissue_absorption(&t->layer[l], nm));
	}
}

/* Reflectance of all orders grows with the stroma's thickness nearly like the first order's a + b (1 - exp(-c T)): three
 * thicknesses 0, h, 2h give c and b, the border layer alone gives a. */
static void effective(double extinction[TISSUE_LAYERS], double source[TISSUE_LAYERS], double abl, struct tissue_memo *memo)
{
	const double cos_view = 0.95, cos_light = 0.85;  // the middle of ways through a cornea
	// h: half of what irises reach, mm, but no deeper than light diffuses (diffusion coefficient of attenuation).
	double absorb = extinction[TISSUE_STROMA] - source[TISSUE_STROMA];
	double h = fmin(0.35, 2 / (sqrt(3 * absorb * extinction[TISSUE_STROMA]) + 1e-9));
	double path = 1 / cos_view + 1 / cos_light, front = 4 * (cos_view + cos_light);
	double r[3];
	tissue_reflectance_forward(r, extinction, source, abl, h, cos_view, cos_light, memo);
	double through = exp(-extinction[TISSUE_ABL] * abl * path);
	double fade = fmin(fmax((r[2] - r[1]) / (r[1] - r[0]), 1e-6), 0.999);
	double decay = -log(fade) / (h * path);
	if (abl > 0)
		source[TISSUE_ABL] = front * r[0] * extinction[TISSUE_ABL] / (1 - through);
	source[TISSUE_STROMA] = front * (r[1] - r[0]) * decay / (through * (1 - fade));
	extinction[TISSUE_STROMA] = decay;
}

void tissue_optics_make_again(struct tissue_optics *optics, const struct tissue *tissue, const struct tissue_bands *bands, struct tissue_memo *memo)
{
	*optics = (struct tissue_optics) {
		.n = bands->n, .abl_thickness = tissue->abl_thickness, .exposure = tissue->exposure
	};
	for (int k = 0; k < bands->n; k++) {
		double extinction[TISSUE_LAYERS], source[TISSUE_LAYERS];
		coefficients(extinction, source, tissue, bands->nm[k]);
		if (tissue->multiple)
			effective(extinction, source, tissue->abl_thickness, memo);
		for (int l = 0; l < TISSUE_LAYERS; l++) {
			optics->extinction[l][k] = extinction[l];
			optics->source[l][k] = source[l];
		}
		for (int c = 0; c < 3; c++)
			optics->rgb[k][c] = bands->rgb[k][c];
	}
}

void tissue_optics_make(struct tissue_optics *optics, const struct tissue *tissue, const struct tissue_bands *bands)
{
	tissue_optics_make_again(optics, tissue, bands, 0);
}
