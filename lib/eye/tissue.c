#include "eye/tissue.h"

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

void tissue_optics_make(struct tissue_optics *optics, const struct tissue *tissue, const struct tissue_bands *bands)
{
	*optics = (struct tissue_optics) {
		.n = bands->n, .abl_thickness = tissue->abl_thickness, .exposure = tissue->exposure
	};
	for (int k = 0; k < bands->n; k++) {
		double scatter = tissue_scattering(bands->nm[k]);
		for (int l = 0; l < TISSUE_LAYERS; l++) {
			double scale = l == TISSUE_STROMA ? tissue->thickness_scale : 1;
			optics->source[l][k] = scale * scatter;
			optics->extinction[l][k] = scale * (scatter + tissue_absorption(&tissue->layer[l], bands->nm[k]));
		}
		for (int c = 0; c < 3; c++)
			optics->rgb[k][c] = bands->rgb[k][c];
	}
}

double tissue_reflectance_at(double extinction_abl, double source_abl, double abl, double extinction_stroma,
                             double source_stroma, double stroma, double cos_view, double cos_light)
{
	double path = 1 / cos_view + 1 / cos_light;
	double through_abl = exp(-extinction_abl * abl * path), through_stroma = exp(-extinction_stroma * stroma * path);
	double sum = source_abl / extinction_abl * (1 - through_abl)
	             + source_stroma / extinction_stroma * through_abl * (1 - through_stroma);
	return sum / (4 * (cos_view + cos_light));
}

void tissue_reflectance(double rgb[3], const struct tissue_optics *o, double stroma, double cos_view, double cos_light)
{
	rgb[0] = rgb[1] = rgb[2] = 0;
	for (int k = 0; k < o->n; k++) {
		double r = tissue_reflectance_at(o->extinction[TISSUE_ABL][k], o->source[TISSUE_ABL][k], o->abl_thickness,
		                                 o->extinction[TISSUE_STROMA][k], o->source[TISSUE_STROMA][k], stroma, cos_view,
		                                 cos_light);
		for (int c = 0; c < 3; c++)
			rgb[c] += o->rgb[k][c] * r;
	}
}

void tissue_reflectance_full(double rgb[3], const struct tissue *t, const struct observer *observer, double stroma,
                             double cos_view, double cos_light)
{
	rgb[0] = rgb[1] = rgb[2] = 0;
	for (int i = 0; i < SPECTRUM_N; i++) {
		double s = tissue_scattering(spectrum_nm(i)), scale = t->thickness_scale;
		double abl = s + tissue_absorption(&t->layer[TISSUE_ABL], spectrum_nm(i));
		double str = s + tissue_absorption(&t->layer[TISSUE_STROMA], spectrum_nm(i));
		double r = tissue_reflectance_at(abl, s, t->abl_thickness, scale * str, scale * s, stroma, cos_view, cos_light);
		for (int c = 0; c < 3; c++)
			rgb[c] += observer->weight[c][i] * r;
	}
}
