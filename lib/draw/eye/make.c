#include "draw/eye/make.h"

#include <math.h>

#include "tissue/spread.h"

/* The mean of the three places of the iris paper, section 4, weighted by their share of the area; tissue with hardly any melanin, as
 * in a blue eye. */
const double scene_plain_stroma = 0.48;
const struct tissue scene_plain_tissue = { .layer = { { 0.01, 0.9 }, { 0.002, 0.9 } }, .abl_thickness = 0.03,
	                                        .thickness_scale = 1, .exposure = 1, .illuminant = ILLUMINANT_D65 };

void scene_geometry(struct scene *s)
{
	double aspect = isfinite(s->eye.limbus_aspect) ? s->eye.limbus_aspect : 1;
	s->cornea = eye_cornea(&s->eye);
	s->limbus[0] = s->eye.limbus_radius;
	s->limbus[1] = s->eye.limbus_radius * aspect;
	s->limbus_depth = eye_limbus_depth(&s->eye);
	s->cornea.rim = 1.06 * s->limbus[0];
	double R = s->conf.sclera_radius, r = s->limbus[0];
	s->sclera_z = s->limbus_depth + sqrt(fmax(R * R - r * r, 0));
}

void scene_planes(double z[2], const struct scene *s)
{
	z[0] = s->eye.iris_depth - s->tissue_range[1];
	z[1] = s->eye.iris_depth - s->tissue_range[0] + s->optics.abl_thickness;
}

void scene_set_tissue(struct scene *s, const struct tissue *tissue)
{
	struct tissue_bands bands;
	s->tissue = *tissue;
	tissue_bands_make(&bands, s->conf.bands, tissue->illuminant);
	tissue_optics_make(&s->optics, tissue, &bands);
	double flat[3];
	tissue_reflectance(flat, &s->optics, scene_plain_stroma, 1, 1);
	for (int c = 0; c < 3; c++)
		s->flat[c] = (float)(flat[c] * s->optics.exposure);
}

/* Mean thickness of the stroma next to the limbus, where shadows of it fall, mm. */
static double rim_thickness(const struct scene *s)
{
	const struct scene_level *l = &s->level[s->n_levels - 1];
	double sum = 0, all = 0;
	for (int i = 0; i < l->n * l->n; i++) {
		double r = hypot((i % l->n + 0.5) / l->per_mm - s->extent, (i / l->n + 0.5) / l->per_mm - s->extent) / s->limbus[0];
		if (r > 0.75 && r < 0.95) {
			sum += l->relief[2 * i + 1];
			all++;
		}
	}
	return all > 0 ? sum / all : scene_plain_stroma;
}

void scene_rim_make(struct scene *s)
{
	static const double nm[3] = TISSUE_PRIMARIES_NM;
	double thick = rim_thickness(s);
	s->rim = rim_shadow_of(&s->eye, s->conf.limbus_width, tissue_spread(&s->tissue, TISSUE_SPREAD_NM, thick));
	for (int c = 0; c < 3; c++)
		s->spread[c] = (float)tissue_spread(&s->tissue, nm[c], thick);
}
