#include "tissue/relief/model.h"

#include <math.h>

static double luminance(const double rgb[3])
{
	return 0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2];
}

void relief_table_make(struct relief_table *t, double low, double high, const double white[3], const double x[PIGMENT_N],
                       const struct pigment_conf *conf)
{
	struct tissue tissue = pigment_tissue(x, conf);
	struct tissue_bands bands;
	struct tissue_optics optics;
	tissue_bands_make(&bands, conf->bands, conf->illuminant);
	tissue_optics_make(&optics, &tissue, &bands);
	t->low = log(low);
	t->step = log(high / low) / (RELIEF_TABLE - 1);
	for (int i = 0; i < RELIEF_TABLE; i++) {
		double rgb[3];
		pigment_model(rgb, x, &optics, exp(t->low + i * t->step), conf);
		for (int c = 0; c < 3; c++)
			t->rgb[i][c] = (float)(rgb[c] *= white[c]);
		t->light[i] = (float)luminance(rgb);
	}
	for (int i = 0; i < RELIEF_TABLE; i++) {
		int a = i ? i - 1 : 0, b = i < RELIEF_TABLE - 1 ? i + 1 : i;
		t->slope[i] = (float)((t->light[b] - t->light[a]) / ((b - a) * t->step));
	}
}

double relief_kappa(const struct tissue *tissue)
{
	const double nm = 550;  // where luminance is
	double scatter = tissue_scattering(nm), share[TISSUE_LAYERS];
	for (int l = 0; l < TISSUE_LAYERS; l++) {
		double absorb = tissue_absorption(&tissue->layer[l], nm);
		share[l] = absorb / (absorb + scatter);
	}
	double extinction = tissue->thickness_scale * scatter / (1 - share[TISSUE_STROMA]);
	return sqrt(extinction / 4) * (0.08 * share[TISSUE_ABL] + 0.42 * share[TISSUE_STROMA]);
}
