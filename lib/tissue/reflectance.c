/* First-order scattering in parallel layers, in closed form. */
#include <math.h>

#include "tissue/tissue.h"

double tissue_reflectance_one(const double extinction[TISSUE_LAYERS], const double source[TISSUE_LAYERS], double abl,
                              double stroma, double cos_view, double cos_light)
{
	double path = 1 / cos_view + 1 / cos_light;
	double through_abl = exp(-extinction[TISSUE_ABL] * abl * path);
	double through_stroma = exp(-extinction[TISSUE_STROMA] * stroma * path);
	double sum = source[TISSUE_ABL] / extinction[TISSUE_ABL] * (1 - through_abl)
	             + source[TISSUE_STROMA] / extinction[TISSUE_STROMA] * through_abl * (1 - through_stroma);
	return sum / (4 * (cos_view + cos_light));
}

void tissue_reflectance(double rgb[3], const struct tissue_optics *o, double stroma, double cos_view, double cos_light)
{
	rgb[0] = rgb[1] = rgb[2] = 0;
	for (int k = 0; k < o->n; k++) {
		const double extinction[] = { o->extinction[TISSUE_ABL][k], o->extinction[TISSUE_STROMA][k] };
		const double source[] = { o->source[TISSUE_ABL][k], o->source[TISSUE_STROMA][k] };
		double r = tissue_reflectance_one(extinction, source, o->abl_thickness, stroma, cos_view, cos_light);
		for (int c = 0; c < 3; c++)
			rgb[c] += o->rgb[k][c] * r;
	}
}
