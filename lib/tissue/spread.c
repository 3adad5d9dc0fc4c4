#include "tissue/spread.h"

#include <math.h>
#include <stdlib.h>

#include "base/mem.h"
#include "bridge/cv_blur.h"

/* ln of what all orders reflect, at the middle of ways through a cornea (tissue.c). */
static double ln_reflected(const double absorb[TISSUE_LAYERS], const double source[TISSUE_LAYERS], double abl, double stroma)
{
	const double cos_view = 0.95, cos_light = 0.85;
	double out[3], extinction[TISSUE_LAYERS];
	for (int l = 0; l < TISSUE_LAYERS; l++)
		extinction[l] = source[l] + absorb[l];
	tissue_reflectance_forward(out, extinction, source, abl, stroma, cos_view, cos_light, 0);
	return log(fmax(out[1], 1e-12));
}

/* -d ln R / d absorption of a layer, mm: one-sided to the second order, for absorption has no other side. */
static double mean_way(const double absorb[TISSUE_LAYERS], const double source[TISSUE_LAYERS], double abl, double stroma, int layer)
{
	double at[3], h = 0.02 * (source[layer] + absorb[layer]);
	for (int k = 0; k < 3; k++) {
		double more[TISSUE_LAYERS] = { absorb[TISSUE_ABL], absorb[TISSUE_STROMA] };
		more[layer] += k * h;
		at[k] = ln_reflected(more, source, abl, stroma);
	}
	return fmax((3 * at[0] - 4 * at[1] + at[2]) / (2 * h), 0);
}

double tissue_spread(const struct tissue *t, double nm, double stroma)
{
	double absorb[TISSUE_LAYERS], source[TISSUE_LAYERS], square = 0;
	if (!t->multiple)
		return 0;
	for (int l = 0; l < TISSUE_LAYERS; l++) {
		double scale = l == TISSUE_STROMA ? t->thickness_scale : 1;
		absorb[l] = scale * tissue_absorption(&t->layer[l], nm);
		source[l] = scale * tissue_scattering(nm);
	}
	for (int l = 0; l < TISSUE_LAYERS; l++) {
		double way = mean_way(absorb, source, t->abl_thickness, stroma, l), free = 1 / source[l];
		square += 2.0 / 3 * way * way * free / (way + free);
	}
	return sqrt(square);
}

bool tissue_spread_map(float *map, int n, int channels, double sigma, struct err *err)
{
	const size_t all = (size_t)n * (size_t)n * (size_t)channels;
	float *wide = mem_array(all, sizeof *wide);
	bool ok = cv_blur(wide, map, n, n, channels, TISSUE_SPREAD_WIDE * sigma, err)
	          && cv_blur(map, map, n, n, channels, TISSUE_SPREAD_NARROW * sigma, err);
	for (size_t i = 0; ok && i < all; i++)
		map[i] += (float)TISSUE_SPREAD_SHARE * (wide[i] - map[i]);
	free(wide);
	return ok;
}
