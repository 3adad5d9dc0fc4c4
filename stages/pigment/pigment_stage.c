#include "stages/pigment/pigment_stage.h"

#include <math.h>
#include <stdlib.h>

#include "anatomy/light.h"
#include "base/json.h"
#include "base/mem.h"
#include "image/exr.h"
#include "stages/pigment/find_white.h"
#include "tissue/light/iris_light.h"
#include "tissue/pigment/melanin_file.h"

enum { FELLOW_MAPS = 6 };  // two of each eye that a capture may have

/* An eye on its way. */
struct work {
	bool told;                 // the light
	struct image clean, thickness;
	double extent;
	struct pupil pupil;
	struct found_white found;
	struct pigment_conf conf;  // as used: the cosines, the exposure's prior
	struct pigment_classes classes;
	struct pigment_fit fit;
	struct melanin_map map;    // empty: one melanin
};

const char *const pigment_orders[] = { "single", "multiple", 0 }, *const pigment_whites[] = { "sclera", "card", "camera", 0 };
const char *const pigment_melanins[] = { "one", "map", 0 };

bool pigment_stage_check(struct pigment_stage_conf *c, struct err *err)
{
	c->fit.illuminant = (enum illuminant)c->illuminant;
	c->fit.multiple = c->order == 1;
	c->fit.melanin_ring = c->melanin == MELANIN_MAP ? c->melanin_ring : 0;
	if (!(c->classes.outer > c->classes.inner))
		return err_set(err, "pigment.outer = %g: must be above pigment.inner = %g", c->classes.outer, c->classes.inner);
	if (!(c->white.pale.outer > c->white.pale.inner))
		return err_set(err, "pigment.sclera_outer = %g: must be above pigment.sclera_inner = %g", c->white.pale.outer, c->white.pale.inner);
	double (*prior)[2] = c->fit.prior;
	for (int l = 0; l < TISSUE_LAYERS; l++) {
		int melanin = l ? PIGMENT_STROMA_MELANIN : PIGMENT_ABL_MELANIN, ratio = l ? PIGMENT_STROMA_RATIO : PIGMENT_ABL_RATIO;
		prior[melanin][0] = log(c->prior_melanin[l][0]);
		prior[melanin][1] = c->prior_melanin[l][1];
		prior[ratio][0] = c->prior_ratio[l][0];
		prior[ratio][1] = fmax(c->prior_ratio[l][1], 1e-4);
	}
	const double *exposure = c->fit.multiple ? c->prior_exposure : c->prior_exposure_single;
	prior[PIGMENT_SCALE][0] = log(c->prior_scale[0]);
	prior[PIGMENT_SCALE][1] = c->prior_scale[1];
	prior[PIGMENT_EXPOSURE][0] = log(exposure[0]);
	prior[PIGMENT_EXPOSURE][1] = exposure[1];
	prior[PIGMENT_RED][1] = prior[PIGMENT_BLUE][1] = c->prior_white;
	prior[PIGMENT_VEIL][1] = c->fit.polarised ? 1e-4 : c->prior_veil;
	c->fit.prior_spread[0] = log(c->prior_spread[0]);
	c->fit.prior_spread[1] = c->prior_spread[1];
	return true;
}

/* The other eye's files where its white may count, too: two maps of each eye that is beside this one in a photograph, and the fits. */
static int fellow_inputs(const char *in[], char *maps[], const struct capture *capture, int eye)
{
	int n = 0;
	for (int i = 0; i < capture->n_photos; i++) {
		const struct capture_photo *fellow = capture->photos[i].eye == eye ? capture_fellow(capture, &capture->photos[i]) : 0;
		if (!fellow)
			continue;
		in[n++] = fellow->fit;
		if (!maps[2 * fellow->eye]) {
			in[n++] = maps[2 * fellow->eye] = mem_printf("%s/clean.exr", capture->eyes[fellow->eye].iris);
			in[n++] = maps[2 * fellow->eye + 1] = mem_printf("%s/texture.json", capture->eyes[fellow->eye].iris);
		}
	}
	return n;
}

/* The files an eye's pigment follows from: three maps, then photograph and fit of each of its photographs. */
static int inputs(const char *in[], char *own[3], const struct capture *capture, int eye)
{
	const char *iris = capture->eyes[eye].iris;
	own[0] = mem_printf("%s/clean.exr", iris);
	own[1] = mem_printf("%s/thickness.exr", iris);
	own[2] = mem_printf("%s/texture.json", iris);
	int n = 0;
	for (; n < 3; n++)
		in[n] = own[n];
	for (int i = 0; i < capture->n_photos; i++) {
		if (capture->photos[i].eye == eye) {
			in[n++] = capture->photos[i].file;
			in[n++] = capture->photos[i].fit;
		}
	}
	return n;
}

/* Where the light is from; of the sclera's shading in each photograph, its slopes with their sigmas: the renderer's light, too. */
static json_t *light_json(const struct work *w)
{
	json_t *out = json_object();
	json_object_set_new(out, "source", json_string(w->told ? "told" : "sclera"));
	json_t *photos = json_array();
	for (int i = 0; !w->told && i < w->found.n_lights; i++) {
		const struct found_light *l = &w->found.lights[i];
		json_t *photo = json_object();
		json_object_set_new(photo, "name", json_string(l->photo));
		json_object_set_new(photo, "slope", json_numbers(2, l->shading.slope));
		json_object_set_new(photo, "slope_sigma", json_numbers(2, l->shading.sigma));
		json_array_append_new(photos, photo);
	}
	json_object_set_new(out, "photos", photos);
	return out;
}

/* level: of the light on the eye over the white's own; without a sclera the exposure of the fit (and its sigma, ln) tells it, where the white does not. sclera: its albedo, as light as
 * conf has it, in the hue that it has under the white. */
static json_t *white_json(const struct work *w, const struct white_conf *conf, double exposure, double sigma)
{
	const struct white *of = &w->found.white;
	json_t *out = json_object();
	const double level = of->sclera[1] > 0 || of->source != WHITE_CAMERA ? white_level(of, w->told, conf) : exposure, light = white_level(of, true, conf);
	json_object_set_new(out, "source", json_string(white_names[of->source]));
	json_object_set_new(out, "photo", json_string(w->found.photo ? w->found.photo : ""));
	json_object_set_new(out, "both_eyes", json_boolean(w->found.joined));
	json_object_set_new(out, "rgb", json_numbers(3, of->rgb));
	json_object_set_new(out, "level", json_number(level));
	json_object_set_new(out, "level_sigma", json_number(of->sclera[1] > 0 ? white_level_sigma(of, w->told) : sigma));  // of ln
	if (of->sclera[1] > 0)
		json_object_set_new(out, "sclera", json_numbers(3, (double[3]){ of->sclera[0] / light, of->sclera[1] / light, of->sclera[2] / light }));
	json_object_set_new(out, "share", json_number(of->share));
	json_object_set_new(out, "spread", json_number(of->spread));
	return out;
}

/* How much of white's error as fitted, ln, is the white's: small ones are the model's, that has no paint nor all irises' pigments. */
static double believed(double error, double doubt)
{
	return error == 0 ? 0 : error * error * error / (error * error + doubt * doubt);
}

static char *extra_json(const struct work *w, const struct pigment_stage_conf *c)
{
	json_t *out = json_object(), *white;
	const double *x = w->fit.x, exposure = exp(x[PIGMENT_EXPOSURE] - w->conf.prior[PIGMENT_EXPOSURE][0]);
	json_object_set_new(out, "white", white = white_json(w, &c->white, exposure, w->fit.sigma[PIGMENT_EXPOSURE]));
	json_object_set_new(white, "error", json_numbers(3, (double[3]){ exp(believed(x[PIGMENT_RED], c->white_doubt)), 1, exp(believed(x[PIGMENT_BLUE], c->white_doubt)) }));
	json_object_set_new(out, "light", light_json(w));
	if (w->map.n)
		json_object_set_new(out, "melanin_map", melanin_json(&w->map, &w->fit));
	json_object_set_new(out, "note", json_string("How thick the stroma is for light against its melanin, and exposure against all of them, are what one "
	                                               "photograph tells least apart."));
	char *text = json_dumps(out, 0);
	json_decref(out);
	return text;
}

static void report(struct stage *stage, const struct capture_eye *eye, const struct work *w)
{
	const struct pigment_fit *f = &w->fit;
	const double *x = f->x;
	stage_note(stage, "%s: border layer melanin %.2f %% (eumelanin %.0f %%), stroma %.2f %% (%.0f %%), scale %.2f, exposure %.2f",
	           eye->side, 100 * exp(x[PIGMENT_ABL_MELANIN]), 100 * x[PIGMENT_ABL_RATIO], 100 * exp(x[PIGMENT_STROMA_MELANIN]),
	           100 * x[PIGMENT_STROMA_RATIO], exp(x[PIGMENT_SCALE]), exp(x[PIGMENT_EXPOSURE]));
	stage_note(stage, "%s: white from the %s%s, %d of %d starts' minima differ, residual %.0f %%, of colour alone %.0f %%", eye->side,
	           white_names[w->found.white.source], w->found.joined ? " beside both eyes" : "", f->minima - 1, f->starts, 100 * f->residual, 100 * f->residual_colour);
	if (w->map.n)
		stage_note(stage, "%s: melanin differs: x %.2f at the pupil, x %.2f at the root", eye->side, exp(f->ring[0].melanin),
		           exp(f->ring[f->rings - 1].melanin));
	stage_figure(stage, "residual", 100 * f->residual, "%");
	stage_figure(stage, "residual_colour", 100 * f->residual_colour, "%");
	stage_figure(stage, "abl_melanin", 100 * exp(x[PIGMENT_ABL_MELANIN]), "%");
	stage_figure(stage, "stroma_melanin", 100 * exp(x[PIGMENT_STROMA_MELANIN]), "%");
	stage_figure(stage, "minima", f->minima, "");
	stage_figure(stage, "held_by_priors", f->directions, "of 9 directions");
	if (w->found.white.source == WHITE_CAMERA)
		stage_skipped(stage, "%s: no white taken from the photograph: too little sclera beside the iris. Show more of the white of "
		              "the eye, or a grey card (photo.NAME.card_px)", eye->side);
}

/* Mean cosine of the light on the iris, by its strength. */
static double mean_cosine(const struct image *light)
{
	double sum = 0, all = 0;
	for (long i = 0; i < (long)light->width * light->height; i++) {
		const float *p = light->px + 4 * i;
		double level = p[0] + p[1] + p[2];
		sum += level * p[3];
		all += level;
	}
	return all > 0 ? fmin(fmax(sum / all, 0.1), 1) : 0.84;  // 0.84: of even light
}

/* Light and white, then classes, then pigments. */
static bool compute(struct work *w, char *const own[3], struct stage *stage, const struct capture *capture, int eye, const struct eye *anatomy,
                    const struct envmap *told, const struct pigment_stage_conf *c, struct err *err)
{
	static const char *const rgbw[] = { "R", "G", "B", "W" }, *const thickness[] = { "Y" };
	struct exr_info info = { 0 };
	if (!exr_read(&w->clean, stage_path(stage, "%s", own[0]), 4, rgbw, PIGMENT_MAP_LIMIT_PX, &info, err)
	    || !exr_read(&w->thickness, stage_path(stage, "%s", own[1]), 1, thickness, PIGMENT_MAP_LIMIT_PX, 0, err)
	    || !pupil_load(&w->pupil, stage_path(stage, "%s", own[2]), c->pupil_radius, err)
	    || !find_white(&w->found, stage, capture, eye, anatomy, told, info.extent_mm, c, err))
		return false;
	if (w->clean.width != w->thickness.width || w->clean.height != w->thickness.height)
		return err_set(err, "%s: not the grid of %s", own[1], own[0]);
	w->told = told;
	w->extent = info.extent_mm;
	w->conf = c->fit;
	w->conf.cos_view = w->found.cos_view;
	w->conf.cos_light = mean_cosine(&w->found.light);
	double *exposure = w->conf.prior[PIGMENT_EXPOSURE];
	if (!told)
		exposure[1] = hypot(exposure[1], c->light_unknown);
	if (w->found.white.source == WHITE_CAMERA)
		exposure[1] = hypot(exposure[1], c->white_unknown);
	const struct pigment_texture t = { &w->clean, &w->thickness, &w->found.light, info.extent_mm, &w->pupil,
		                                anatomy->limbus_radius + c->root_beyond_limbus, w->found.white.rgb };
	if (!pigment_classify(&w->classes, &t, &c->classes, err) || !pigment_solve(&w->fit, &w->classes, &w->conf, 0, err))
		return false;
	return c->melanin == MELANIN_ONE || melanin_fit(&w->map, &t, &w->fit, &w->conf, &c->classes, &c->map, err);
}

/* White alone, of no colour. */
static bool compute_grey(struct work *w, struct stage *stage, const struct capture *capture, int eye, const struct eye *anatomy,
                         const struct envmap *told, const struct pigment_stage_conf *c, struct err *err)
{
	struct pigment_stage_conf grey = *c;
	double *sclera = grey.white.sclera;
	sclera[0] = sclera[1] = sclera[2] = 0.2126 * sclera[0] + 0.7152 * sclera[1] + 0.0722 * sclera[2];
	w->told = told;
	return find_white(&w->found, stage, capture, eye, anatomy, told, anatomy->limbus_radius, &grey, err);
}

/* Whether texture.json says that the texture has no colour. Older ones do not say. */
static bool is_grey(const char *texture_json)
{
	struct err err = { 0 };
	json_t *texture = json_read(texture_json, 1 << 22, &err);
	bool grey = json_is_false(json_object_get(texture, "colour"));
	json_decref(texture);
	return grey;
}

/* The light on the iris, which relief needs, too. */
static bool write_light(const struct work *w, const char *path, const char *made_by, struct err *err)
{
	struct image lit = iris_lit(&w->found.light, &w->found.slant);
	const struct exr_info info = { .extent_mm = w->extent, .made_by = made_by };
	bool ok = exr_write(path, &lit, iris_lit_names, EXR_FLOAT, &info, err);
	image_free(&lit);
	return ok;
}

static bool write_fit(struct work *w, const char *out, const char *lit, int n, const char *const in[], struct stage *stage, const struct capture_eye *eye,
                      const struct pigment_stage_conf *conf, struct err *err)
{
	char *extra = extra_json(w, conf);
	bool ok = write_light(w, stage_path(stage, "%s", lit), stage_made_by(stage, n, in), err) && pigment_save(&w->fit, &w->classes, &w->conf, stage_path(stage, "%s", out),
	                                                                                                      stage_made_by(stage, n, in), extra, err);
	free(extra);
	if (ok)
		report(stage, eye, w);
	return ok;
}

/* Grey photographs tell no pigments; how bright white is in them they do. */
static bool write_none(struct work *w, const char *out, int n, const char *const in[], struct stage *stage, const struct capture_eye *eye,
                       const struct white_conf *conf, struct err *err)
{
	static const char reason[] = "the photographs are grey: pigments are told by their colour";
	json_t *extra = json_pack("{s:o}", "white", white_json(w, conf, 1, INFINITY));
	char *text = json_dumps(extra, 0);
	stage_skipped(stage, "%s: no pigments: %s. Photograph the eye in colour", eye->side, reason);
	bool ok = pigment_save_none(reason, stage_path(stage, "%s", out), stage_made_by(stage, n, in), text, err);
	free(text);
	json_decref(extra);
	return ok;
}

/* The light that capture.conf tells. */
static bool light_told(struct envmap *env, struct stage *stage, const struct pigment_stage_conf *c, struct err *err)
{
	if (!c->light)
		return true;
	if (!light_load(env, 0, stage, "light.environment", c->light, err))
		return false;
	envmap_normalise(env);
	return true;
}

bool pigment_stage(struct stage *stage, const struct capture *capture, int i, const struct eye *anatomy,
                   const struct pigment_stage_conf *conf, struct err *err)
{
	const struct capture_eye *eye = &capture->eyes[i];
	char *own[3], *theirs[FELLOW_MAPS] = { 0 }, *out = mem_printf("%s/pigment.json", eye->iris), *lit = mem_printf("%s/light.exr", eye->iris);
	const char **in = mem_new(4 + FELLOW_MAPS + 3 * (size_t)capture->n_photos, sizeof *in);
	int n = inputs(in, own, capture, i);
	n += fellow_inputs(in + n, theirs, capture, i);
	struct work w = { 0 };
	struct envmap told = { 0 };
	if (conf->light)
		in[n++] = conf->light;
	bool ok = light_told(&told, stage, conf, err);
	bool grey = ok && is_grey(stage_path(stage, "%s", own[2]));
	if (ok && !(stage_fresh(stage, out, n, in) && (grey || stage_fresh(stage, lit, n, in)))) {
		if (grey)
			ok = compute_grey(&w, stage, capture, i, anatomy, conf->light ? &told : 0, conf, err) && write_none(&w, out, n, in, stage, eye, &conf->white, err);
		else
			ok = compute(&w, own, stage, capture, i, anatomy, conf->light ? &told : 0, conf, err) && write_fit(&w, out, lit, n, in, stage, eye, conf, err)
			     && stage_made(stage, lit, n, in, err);
		ok = ok && stage_made(stage, out, n, in, err);
	}
	image_free(&w.clean);
	image_free(&w.thickness);
	image_free(&w.found.light);
	image_free(&w.found.slant);
	free(w.found.lights);
	envmap_free(&told);
	for (int k = 0; k < 3; k++)
		free(own[k]);
	for (int k = 0; k < FELLOW_MAPS; k++)
		free(theirs[k]);
	free(in);
	free(out);
	free(lit);
	return ok;
}
