#include "draw/web/tissue.h"

#include <math.h>

#include "base/file.h"
#include "base/json.h"
#include "base/mem.h"

static const char *const names[] = { "abl_melanin", "abl_ratio", "stroma_melanin", "stroma_ratio", "thickness_scale" };
static const char *const keys[][2] = { { "abl", "melanin" }, { "abl", "eumelanin_ratio" }, { "stroma", "melanin" },
	                                   { "stroma", "eumelanin_ratio" }, { "stroma", "thickness_scale" } };

/* The intervals of one sigma that pigment.json states; empty where nothing was fitted. */
static json_t *intervals(const char *path)
{
	json_t *out = json_object();
	struct err err = { 0 };
	json_t *root = path && file_exists(path) ? json_read(path, 1 << 22, &err) : 0;
	for (int i = 0; i < COUNT(names); i++) {
		json_t *entry = json_object_get(json_object_get(root, keys[i][0]), keys[i][1]);
		double v[2];
		if (json_is_object(entry) && json_get_array(v, 2, entry, "interval", path, &err))
			json_object_set_new(out, names[i], json_numbers(2, v));
	}
	json_decref(root);
	return out;
}

/* For each wavelength: absorption with eumelanin alone, pheomelanin alone, neither; scattering (all 1/mm); its colour. */
static json_t *spectra(int n, enum illuminant illuminant)
{
	static const struct tissue_layer eumelanin = { 1, 1 }, pheomelanin = { 1, 0 }, none = { 0, 0 };
	struct tissue_bands bands;
	json_t *out = json_array();
	tissue_bands_make(&bands, n, illuminant);
	for (int k = 0; k < n; k++) {
		double v[] = { bands.nm[k], tissue_absorption(&eumelanin, bands.nm[k]), tissue_absorption(&pheomelanin, bands.nm[k]),
		               tissue_absorption(&none, bands.nm[k]), tissue_scattering(bands.nm[k]), bands.rgb[k][0], bands.rgb[k][1],
		               bands.rgb[k][2] };
		json_array_append_new(out, json_numbers(COUNT(v), v));
	}
	return out;
}

json_t *web_tissue(const struct web_source *source)
{
	enum { BANDS = 4 };  // what the shader carries in one vector
	const struct tissue t = source->scene->tissue;
	double value[] = { t.layer[0].melanin, t.layer[0].eumelanin_ratio, t.layer[1].melanin, t.layer[1].eumelanin_ratio,
		               t.thickness_scale };
	json_t *out = json_object(), *fitted = json_object();
	for (int i = 0; i < COUNT(names); i++)
		json_object_set_new(fitted, names[i], json_number(value[i]));
	json_object_set_new(out, "fitted", fitted);
	json_object_set_new(out, "interval", intervals(source->pigment));
	json_object_set_new(out, "abl", json_number(t.abl_thickness));
	json_object_set_new(out, "exposure", json_number(t.exposure));
	json_object_set_new(out, "multiple", json_boolean(t.multiple));
	json_object_set_new(out, "anisotropy", json_number(TISSUE_ANISOTROPY));
	json_object_set_new(out, "bands", spectra(BANDS, t.illuminant));
	struct tissue_bands bands;
	struct tissue_optics optics;
	tissue_bands_make(&bands, BANDS, t.illuminant);
	tissue_optics_make(&optics, &t, &bands);
	json_t *check = json_array();
	for (int k = 0; k < BANDS; k++) {
		double v[] = { optics.extinction[0][k], optics.source[0][k], optics.extinction[1][k], optics.source[1][k] };
		json_array_append_new(check, json_numbers(COUNT(v), v));
	}
	json_object_set_new(out, "optics", check);
	return out;
}
