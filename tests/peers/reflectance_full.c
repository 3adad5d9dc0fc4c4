#include "tests/peers/reflectance_full.h"

void tissue_reflectance_full(double rgb[3], const struct tissue *t, const struct observer *observer, double stroma,
                             double cos_view, double cos_light)
{
	rgb[0] = rgb[1] = rgb[2] = 0;
	for (int i = 0; i < SPECTRUM_N; i++) {
		double nm = spectrum_nm(i), scatter = tissue_scattering(nm), extinction[TISSUE_LAYERS], source[TISSUE_LAYERS];
		for (int l = 0; l < TISSUE_LAYERS; l++) {
			double scale = l == TISSUE_STROMA ? t->thickness_scale : 1;
			source[l] = scale * scatter;
			extinction[l] = scale * (scatter + tissue_absorption(&t->layer[l], nm));
		}
		double all[3], r;
		if (t->multiple)
			tissue_reflectance_forward(all, extinction, source, t->abl_thickness, stroma, cos_view, cos_light, 0);
		r = t->multiple ? all[1] : tissue_reflectance_one(extinction, source, t->abl_thickness, stroma, cos_view, cos_light);
		for (int c = 0; c < 3; c++)
			rgb[c] += observer->weight[c][i] * r;
	}
}
