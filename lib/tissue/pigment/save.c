#include <math.h>

#include "base/json.h"
#include "tissue/pigment/pigment.h"

/* An unknown in its own unit: a logarithm's value with its sigma carried through, and the interval of one sigma. */
static json_t *estimate(const struct pigment_fit *fit, int j)
{
	bool ratio = j == PIGMENT_ABL_RATIO || j == PIGMENT_STROMA_RATIO || j == PIGMENT_VEIL;
	double x = fit->x[j], s = fit->sigma[j], value = ratio ? x : exp(x);
	double ends[2] = { ratio ? x - s : exp(x - s), ratio ? x + s : exp(x + s) };
	json_t *out = json_object();
	json_object_set_new(out, "value", json_number(value));
	json_object_set_new(out, "sigma", json_number(ratio ? s : value * s));
	json_object_set_new(out, "interval", json_numbers(2, ends));
	return out;
}

static json_t *layer(const struct pigment_fit *fit, int melanin, int ratio)
{
	json_t *out = json_object();
	json_object_set_new(out, "melanin", estimate(fit, melanin));
	json_object_set_new(out, "eumelanin_ratio", estimate(fit, ratio));
	return out;
}

static json_t *names(void)
{
	json_t *out = json_array();
	for (int j = 0; j < PIGMENT_N; j++)
		json_array_append_new(out, json_string(pigment_names[j]));
	return out;
}

static json_t *matrix(const double m[PIGMENT_N][PIGMENT_N])
{
	json_t *out = json_array();
	for (int i = 0; i < PIGMENT_N; i++)
		json_array_append_new(out, json_numbers(PIGMENT_N, m[i]));
	return out;
}

/* Combinations that the photograph leaves to the priors: {information, of {unknown: part}}; small parts left out. */
static json_t *undetermined(const struct pigment_fit *fit)
{
	json_t *out = json_array();
	for (int d = 0; d < fit->directions; d++) {
		json_t *of = json_object(), *entry = json_object();
		for (int j = 0; j < PIGMENT_N; j++)
			if (fabs(fit->direction[d][j]) > 0.3)
				json_object_set_new(of, pigment_names[j], json_number(fit->direction[d][j]));
		json_object_set_new(entry, "information", json_number(fit->information[d]));
		json_object_set_new(entry, "of", of);
		json_array_append_new(out, entry);
	}
	return out;
}

static json_t *classes_json(const struct pigment_fit *fit, const struct pigment_classes *classes, const struct pigment_conf *conf)
{
	struct tissue_bands bands;
	tissue_bands_make(&bands, conf->bands, conf->illuminant);
	json_t *out = json_array();
	for (int i = 0; i < classes->n; i++) {
		const struct pigment_class *c = &classes->of[i];
		double rgb[3];
		pigment_class_model(rgb, fit, classes, i, conf, &bands);
		json_t *entry = json_object();
		json_object_set_new(entry, "thickness_mm", json_number(fit->thickness[i]));
		json_object_set_new(entry, "share", json_number(c->share));
		json_object_set_new(entry, "seen", json_numbers(3, c->rgb));
		json_object_set_new(entry, "model", json_numbers(3, rgb));
		json_array_append_new(out, entry);
	}
	return out;
}

static json_t *minima(const struct pigment_fit *fit)
{
	json_t *out = json_array();
	for (int m = 0; m < fit->minima - 1; m++)
		json_array_append_new(out, json_numbers(PIGMENT_N + 1, fit->other[m]));
	return out;
}

static void add_missing(json_t *out, const char *extra)
{
	json_t *more = extra ? json_loads(extra, 0, 0) : 0;
	if (more)
		json_object_update_missing(out, more);
	json_decref(more);
}

bool pigment_save(const struct pigment_fit *fit, const struct pigment_classes *classes, const struct pigment_conf *conf,
                  const char *path, const char *made_by, const char *extra, struct err *err)
{
	json_t *out = json_object();
	json_t *abl = layer(fit, PIGMENT_ABL_MELANIN, PIGMENT_ABL_RATIO), *stroma = layer(fit, PIGMENT_STROMA_MELANIN, PIGMENT_STROMA_RATIO);
	json_object_set_new(abl, "thickness_mm", json_number(conf->abl_thickness));
	json_object_set_new(stroma, "thickness_scale", estimate(fit, PIGMENT_SCALE));
	json_object_set_new(out, "abl", abl);
	json_object_set_new(out, "stroma", stroma);
	json_object_set_new(out, "residual_rgb", json_numbers(3, fit->residual_rgb));
	json_object_set_new(out, "residual", json_number(fit->residual));
	json_object_set_new(out, "residual_colour", json_number(fit->residual_colour));
	json_object_set_new(out, "light_error", json_number(fit->light_error));
	json_object_set_new(out, "model_error", json_number(fit->model_error));
	json_object_set_new(out, "exposure", estimate(fit, PIGMENT_EXPOSURE));
	json_object_set_new(out, "white_red", estimate(fit, PIGMENT_RED));
	json_object_set_new(out, "white_blue", estimate(fit, PIGMENT_BLUE));
	json_object_set_new(out, "veil", estimate(fit, PIGMENT_VEIL));
	json_object_set_new(out, "illuminant", json_string(illuminant_names[conf->illuminant]));
	json_object_set_new(out, "scattering", json_string(conf->multiple ? "multiple" : "single"));
	json_object_set_new(out, "bands", json_integer(conf->bands));
	json_object_set_new(out, "cos_view", json_number(conf->cos_view));
	json_object_set_new(out, "cos_light", json_number(conf->cos_light));
	json_object_set_new(out, "unknowns", names());
	json_object_set_new(out, "correlation", matrix(fit->correlation));
	json_object_set_new(out, "held_by_priors", undetermined(fit));
	json_object_set_new(out, "starts", json_integer(fit->starts));
	json_object_set_new(out, "minima", json_integer(fit->minima));
	json_object_set_new(out, "other_minima", minima(fit));
	json_object_set_new(out, "classes", classes_json(fit, classes, conf));
	add_missing(out, extra);
	bool ok = json_write(path, out, made_by, err);
	json_decref(out);
	return ok;
}

bool pigment_save_none(const char *reason, const char *path, const char *made_by, const char *extra, struct err *err)
{
	json_t *out = json_pack("{s:s}", "without", reason);
	add_missing(out, extra);
	bool ok = json_write(path, out, made_by, err);
	json_decref(out);
	return ok;
}
