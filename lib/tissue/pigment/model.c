#include <math.h>

#include "tissue/pigment/pigment.h"

const char *const pigment_names[PIGMENT_N] = {
	"abl.melanin", "abl.eumelanin_ratio", "stroma.melanin", "stroma.eumelanin_ratio", "stroma.thickness_scale",
	"exposure", "white.red", "white.blue", "veil",
};

struct tissue pigment_tissue(const double x[PIGMENT_N], const struct pigment_conf *c)
{
	return (struct tissue) {
		.layer = { { exp(x[PIGMENT_ABL_MELANIN]), x[PIGMENT_ABL_RATIO] }, { exp(x[PIGMENT_STROMA_MELANIN]), x[PIGMENT_STROMA_RATIO] } },
		.abl_thickness = c->abl_thickness,
		.thickness_scale = exp(x[PIGMENT_SCALE]),
		.exposure = exp(x[PIGMENT_EXPOSURE]),
		.multiple = c->multiple,
		.illuminant = c->illuminant,
	};
}

struct tissue pigment_tissue_beyond(const double x[PIGMENT_N], double beyond, const struct pigment_conf *c)
{
	const double most = log(0.9);
	struct tissue out = pigment_tissue(x, c);
	out.layer[TISSUE_ABL].melanin = exp(fmin(x[PIGMENT_ABL_MELANIN] + beyond, most));
	return out;
}

void pigment_photograph(double seen[3], const double rgb[3], const double x[PIGMENT_N])
{
	double gain[3] = { exp(x[PIGMENT_RED]), 1, exp(x[PIGMENT_BLUE]) };
	for (int k = 0; k < 3; k++)
		seen[k] = exp(x[PIGMENT_EXPOSURE]) * gain[k] * rgb[k] + x[PIGMENT_VEIL];
}

void pigment_model(double rgb[3], const double x[PIGMENT_N], const struct tissue_optics *optics, double stroma,
                   const struct pigment_conf *c)
{
	double bare[3];
	tissue_reflectance(bare, optics, stroma, c->cos_view, c->cos_light);
	pigment_photograph(rgb, bare, x);
}

void pigment_class_model(double rgb[3], const struct pigment_fit *fit, const struct pigment_classes *classes, int i,
                         const struct pigment_conf *conf, const struct tissue_bands *bands)
{
	double beyond = fit->rings ? fit->ring[classes->of[i].ring].melanin : 0;
	struct tissue tissue = pigment_tissue_beyond(fit->x, beyond, conf);
	struct tissue_optics optics;
	tissue_optics_make(&optics, &tissue, bands);
	pigment_model(rgb, fit->x, &optics, fit->thickness[i], conf);
}
