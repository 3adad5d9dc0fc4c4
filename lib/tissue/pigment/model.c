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
