#include "draw/eye/tint.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/json.h"
#include "base/mem.h"
#include "draw/eye/batch_impl.h"
#include "tissue/pigment/melanin_file.h"
#include "tissue/pigment/white.h"

enum { LEVELS = 24 };
static const double cos_view = 0.95, cos_light = 0.85;  // as in tissue.c

/* Optics of the tissue at melanin from `low` on, `step` apart, ln. */
struct table {
	double low, step;
	struct tissue_optics level[LEVELS], own;
};

static void table_make(struct table *t, const struct scene *s, const struct melanin_map *map)
{
	struct tissue_bands bands;
	struct tissue tissue = s->tissue;
	double ln = log(fmax(tissue.layer[TISSUE_ABL].melanin, 1e-6)), low = ln, high = ln;
	for (int i = 0; i < map->n * map->n; i++) {
		low = fmin(low, ln + map->ln[i]);
		high = fmax(high, ln + map->ln[i]);
	}
	low = fmax(low, log(1e-6));
	high = fmin(fmax(high, low + 1e-3), log(0.9));
	t->low = low;
	t->step = (high - low) / (LEVELS - 1);
	tissue_bands_make(&bands, s->conf.bands, tissue.illuminant);
	tissue_optics_make(&t->own, &tissue, &bands);
	for (int l = 0; l < LEVELS; l++) {
		tissue.layer[TISSUE_ABL].melanin = exp(low + l * t->step);
		tissue_optics_make(&t->level[l], &tissue, &bands);
	}
}

static void factor(float out[3], const struct table *t, double ln, double stroma)
{
	const double most = 8;
	double at = fmin(fmax((ln - t->low) / t->step, 0), LEVELS - 1.001), f = at - (int)at, a[3], b[3], own[3];
	tissue_reflectance(a, &t->level[(int)at], stroma, cos_view, cos_light);
	tissue_reflectance(b, &t->level[(int)at + 1], stroma, cos_view, cos_light);
	tissue_reflectance(own, &t->own, stroma, cos_view, cos_light);
	for (int c = 0; c < 3; c++) {
		double dark = fmax(own[c], 1e-4), ratio = pow(fmax(a[c], 1e-4) / dark, 1 - f) * pow(fmax(b[c], 1e-4) / dark, f);
		out[c] = (float)fmin(fmax(ratio, 1 / most), most);
	}
}

static void paint(struct scene *s, const struct melanin_map *map, const double error[3])
{
	enum { EVEN = 2 };  // nodes of a tint that is the same everywhere
	int n = map->n ? map->n : EVEN;
	const struct scene_level *l = &s->level[s->n_levels - 1];
	double ln = log(fmax(s->tissue.layer[TISSUE_ABL].melanin, 1e-6));
	struct table *t = mem_new(1, sizeof *t);
	if (map->n)
		table_make(t, s, map);
	s->tint = image_new(n, n, 3);
	for (int y = 0; y < n; y++)
		for (int x = 0; x < n; x++) {
			double u = (2 * (x + 0.5) / n - 1) * s->extent, v = (2 * (y + 0.5) / n - 1) * s->extent;
			float *rgb = image_at(&s->tint, x, y), stroma = channel_at(l->relief, l->n, l->per_mm, (float)u, (float)v, 2, 1);
			rgb[0] = rgb[1] = rgb[2] = 1;
			if (map->n)
				factor(rgb, t, ln + melanin_at(map, u, v), stroma);
			for (int c = 0; c < 3; c++)
				rgb[c] *= (float)error[c];
		}
	free(t);
}

bool scene_white(struct scene_white *out, const char *path, struct err *err)
{
	const double most = 20, brightest = 0.95;  // of a channel of the sclera; its hue is kept
	*out = (struct scene_white){ .rgb = { 1, 1, 1 } };
	if (!path || !file_exists(path))
		return true;
	json_t *root = json_read(path, 1 << 22, err), *white = json_object_get(root, "white");
	bool ok = root;
	double level = 1, over = brightest;
	for (int c = 0; c < 3; c++)
		out->error[c] = 1;
	if (white) {
		const char *source = json_string_value(json_object_get(white, "source"));
		out->found = true;
		out->told = source && (!strcmp(source, white_names[WHITE_SCLERA]) || !strcmp(source, white_names[WHITE_CARD]));
		ok = json_get_array(out->rgb, 3, white, "rgb", path, err) && (!json_object_get(white, "level") || json_get(&level, white, "level", path, err))
		     && (!json_object_get(white, "error") || json_get_array(out->error, 3, white, "error", path, err));
		out->has_sclera = ok && json_object_get(white, "sclera");
		ok = ok && (!out->has_sclera || json_get_array(out->sclera, 3, white, "sclera", path, err));
	}
	json_decref(root);
	for (int c = 0; c < 3; c++) {
		out->rgb[c] *= level * out->error[c];
		if (ok && !(out->rgb[c] > 1e-4 && out->rgb[c] < 1e4 && out->rgb[c] <= most * out->rgb[1] && most * out->rgb[c] >= out->rgb[1]))
			ok = err_set(err, "%s: white %g, of green %g: must be in [0.0001, 10000], and within %g times green", path, out->rgb[c], out->rgb[1], most);
		if (ok && out->has_sclera && !(out->sclera[c] > 0 && out->sclera[c] < 100))
			ok = err_set(err, "%s: white.sclera: %g: must be above 0, below 100", path, out->sclera[c]);
		over = fmax(over, out->sclera[c]);
	}
	for (int c = 0; c < 3; c++)
		out->sclera[c] *= brightest / over;
	return ok;
}

/* The error of white as fitted, a factor that leaves green, less what of it went into the white; 1 where pigment.json does not tell it. False, err set, when the
 * file is damaged. */
static bool error_of(double error[3], const char *path, struct err *err)
{
	double x[PIGMENT_N], rgb[3];
	struct pigment_conf conf = { 0 };
	struct scene_white white;
	error[0] = error[1] = error[2] = 1;
	if (!scene_white(&white, path, err))
		return false;
	if (!white.found)
		return true;
	if (!pigment_load(x, rgb, &conf, path, err))
		return false;
	error[0] = exp(x[PIGMENT_RED]) / white.error[0];
	error[2] = exp(x[PIGMENT_BLUE]) / white.error[2];
	return true;
}

bool scene_tint_make(struct scene *s, const char *path, struct err *err)
{
	double error[3];
	char reason[256];
	if (!path || !file_exists(path) || tissue_without(reason, path))
		return true;
	struct melanin_map *map = mem_new(1, sizeof *map);
	bool ok = error_of(error, path, err) && melanin_load(map, path, err);
	if (ok)
		paint(s, map, error);
	free(map);
	return ok;
}

void scene_tint_at(float rgb[3], const struct scene *s, float x, float y)
{
	float per_mm = (float)(s->tint.width / (2 * s->extent));
	for (int c = 0; c < 3; c++)
		rgb[c] = s->tint.px ? channel_at(s->tint.px, s->tint.width, per_mm, x, y, 3, c) : 1;
}
