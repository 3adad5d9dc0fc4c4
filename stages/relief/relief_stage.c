#include "stages/relief/relief_stage.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/json.h"
#include "base/mem.h"
#include "image/exr.h"
#include "tissue/light/iris_light.h"
#include "tissue/relief/height.h"

enum { MAP_LIMIT_PX = 1 << 26, INPUTS = 5 };
static const char *const input_names[INPUTS] = { "clean.exr", "texture.json", "thickness.exr", "pigment.json", "light.exr" };

struct work {
	struct image clean, thickness, light, sharp, out;
	struct exr_info info;
	struct pupil pupil;
	double root;
	struct relief_fit fit;
	struct infer_fit infer;
	double height_rms;
	bool without;      // there are no pigments
	char reason[256];  // why
};

/* The thickness as it is: what sharpens it is told by the light of pigments that are known. */
static bool leave_coarse(struct work *w, const struct relief_stage_conf *c, struct err *err)
{
	w->fit = (struct relief_fit){ .before = NAN, .after = NAN, .contrast = NAN, .slope = NAN, .kappa = NAN };
	return relief_apply(&w->sharp, &w->thickness, w->info.extent_mm, &w->fit, &c->relief, err);
}

/* The light of pigment's making: of this texture, and numbers. */
static bool read_light(struct work *w, const char *path, struct err *err)
{
	struct exr_info info = { 0 };
	if (!exr_read(&w->light, path, IRIS_LIT, iris_lit_names, MAP_LIMIT_PX, &info, err))
		return false;
	if (!(fabs(info.extent_mm - w->info.extent_mm) <= 1e-3 * w->info.extent_mm))
		return err_set(err, "%s: extentMm = %g, but the texture's is %g", path, info.extent_mm, w->info.extent_mm);
	for (long i = 0; i < (long)IRIS_LIT * w->light.width * w->light.height; i++)
		if (!(fabsf(w->light.px[i]) < 1e6f))
			return err_set(err, "%s: %g: must be a light's strength or slant", path, (double)w->light.px[i]);
	return true;
}

static bool sharpen(struct work *w, char *const in[], struct stage *stage, const struct relief_stage_conf *c, struct err *err)
{
	double x[PIGMENT_N], white[3];
	struct pigment_conf pigment = { 0 };
	const double extent = w->info.extent_mm;
	if (!pigment_load(x, white, &pigment, stage_path(stage, "%s", in[3]), err)
	    || !relief_solve(&w->fit, &w->clean, &w->thickness, extent, &w->pupil, w->root, white, x, &pigment, &c->relief, err))
		return false;
	if (!c->shading)
		return relief_apply(&w->sharp, &w->thickness, extent, &w->fit, &c->relief, err);
	return read_light(w, stage_path(stage, "%s", in[4]), err)
	       && relief_infer(&w->sharp, &w->infer, &w->clean, &w->thickness, &w->light, extent, &w->pupil, w->root, white, x, &pigment, &c->relief,
	                       &c->infer, err);
}

/* Height against the mean, thickness, and the sigma of its detail, where there is one: the third channel. */
static void take_heights(struct work *w)
{
	struct image heights;
	w->height_rms = relief_heights(&heights, &w->sharp, w->info.extent_mm, &w->pupil, w->root);
	w->out = image_new(heights.width, heights.height, 3);
	for (long i = 0; i < (long)heights.width * heights.height; i++) {
		memcpy(w->out.px + 3 * i, heights.px + 2 * i, 2 * sizeof *heights.px);
		w->out.px[3 * i + 2] = w->sharp.channels > 1 ? w->sharp.px[2 * i + 1] : 0;
	}
	image_free(&heights);
}

static bool compute(struct work *w, char *const in[], struct stage *stage, const struct eye *anatomy,
                    const struct relief_stage_conf *c, struct err *err)
{
	static const char *const rgbw[] = { "R", "G", "B", "W" }, *const thickness[] = { "Y" };
	w->without = tissue_without(w->reason, stage_path(stage, "%s", in[3]));
	w->root = anatomy->limbus_radius + c->root_beyond_limbus;
	if (!exr_read(&w->clean, stage_path(stage, "%s", in[0]), 4, rgbw, MAP_LIMIT_PX, &w->info, err)
	    || !pupil_load(&w->pupil, stage_path(stage, "%s", in[1]), c->pupil_radius, err)
	    || !exr_read(&w->thickness, stage_path(stage, "%s", in[2]), 1, thickness, MAP_LIMIT_PX, 0, err))
		return false;
	if (w->clean.width != w->thickness.width || w->clean.height != w->thickness.height || w->clean.width != w->clean.height)
		return err_set(err, "%s: not the grid of %s", in[2], in[0]);
	if (!(w->without ? leave_coarse(w, c, err) : sharpen(w, in, stage, c, err)))
		return false;
	take_heights(w);
	return true;
}

static bool save_fit(const struct work *w, const struct relief_conf *c, const char *path, const char *made_by, struct err *err)
{
	const struct relief_fit *f = &w->fit;
	json_t *out = json_object();
	json_object_set_new(out, "band_mm", json_numbers(RELIEF_BANDS, c->band));
	json_object_set_new(out, "gain", json_numbers(RELIEF_BANDS, f->gain));
	json_object_set_new(out, "gain_sigma", json_numbers(RELIEF_BANDS, f->gain_sigma));
	json_object_set_new(out, "residual_coarse", json_number(f->before));
	json_object_set_new(out, "residual", json_number(f->after));
	json_object_set_new(out, "contrast", json_number(f->contrast));
	json_object_set_new(out, "light_per_thickness", json_number(f->slope));
	json_object_set_new(out, "kappa", json_number(f->kappa));
	if (w->infer.iterations) {
		const struct infer_fit *i = &w->infer;
		json_t *shading = json_object();
		json_object_set_new(shading, "rms", json_numbers(INFER_OCTAVES, i->rms));
		json_object_set_new(shading, "response", json_numbers(INFER_OCTAVES, i->response));
		json_object_set_new(shading, "contrast", json_numbers(INFER_OCTAVES, i->contrast));
		json_object_set_new(shading, "not_relief", json_numbers(INFER_OCTAVES, i->other));
		json_object_set_new(shading, "noise", json_number(i->noise));
		json_object_set_new(shading, "residual_course", json_number(i->before));
		json_object_set_new(shading, "residual", json_number(i->after));
		json_object_set_new(out, "shading", shading);
	}
	json_object_set_new(out, "height_rms_mm", json_number(w->height_rms));
	bool ok = json_write(path, out, made_by, err);
	json_decref(out);
	return ok;
}

static void report(struct stage *stage, const struct capture_eye *eye, const struct work *w)
{
	const struct relief_fit *f = &w->fit;
	if (w->without) {
		stage_figure(stage, "height_rms", w->height_rms, "mm");
		stage_skipped(stage, "%s: the relief is the coarse field, lighter for thicker, not sharpened: %s", eye->side, w->reason);
		return;
	}
	if (w->infer.iterations)
		stage_note(stage, "%s: shading: ln thickness varies by %.3f, %.3f, %.3f, %.3f in its octaves, finest first; noise %.1f %%, detail differs by %.1f %% "
		           "(without relief %.1f %%), relief %.3f mm rms", eye->side, w->infer.rms[0], w->infer.rms[1], w->infer.rms[2], w->infer.rms[3],
		           100 * w->infer.noise, 100 * w->infer.after, 100 * w->infer.before, w->height_rms);
	else
		stage_note(stage, "%s: gains %.2f %.2f %.2f, detail differs by %.1f %% (coarse %.1f %%, of %.1f %%), relief %.3f mm rms", eye->side,
	           f->gain[0], f->gain[1], f->gain[2], 100 * f->after, 100 * f->before, 100 * f->contrast, w->height_rms);
	stage_figure(stage, "detail_residual", 100 * f->after, "%");
	stage_figure(stage, "detail_residual_coarse", 100 * f->before, "%");
	stage_figure(stage, "height_rms", w->height_rms, "mm");
	if (f->slope < 0.1 && f->kappa < 0.05)
		stage_skipped(stage, "%s: the stroma is so pigmented that its brightness says little about its thickness (%.2f %% of light "
		              "for 1 %% of thickness): its relief is the coarse field, lighter for thicker, not measured",
		              eye->side, f->slope);
}

bool relief_stage(struct stage *stage, const struct capture_eye *eye, const struct eye *anatomy,
                  const struct relief_stage_conf *conf, struct err *err)
{
	static const char *const channels[] = { "Y", "T", "S" };
	char *in[INPUTS], *out = mem_printf("%s/relief.exr", eye->iris), *json = mem_printf("%s/relief.json", eye->iris);
	for (int i = 0; i < INPUTS; i++)
		in[i] = mem_printf("%s/%s", eye->iris, input_names[i]);
	const char *const *from = (const char *const *)in;
	struct work w = { 0 };
	const int n = conf->shading && !tissue_without(w.reason, stage_path(stage, "%s", in[3])) ? INPUTS : INPUTS - 1;
	bool ok = stage_fresh(stage, out, n, from) && stage_fresh(stage, json, n, from);
	if (!ok) {
		const char *made_by = stage_made_by(stage, n, from);
		ok = compute(&w, in, stage, anatomy, conf, err);
		w.info.made_by = made_by;
		ok = ok && exr_write(stage_path(stage, "%s", out), &w.out, channels, EXR_HALF, &w.info, err)
		     && save_fit(&w, &conf->relief, stage_path(stage, "%s", json), made_by, err)
		     && stage_made(stage, out, n, from, err) && stage_made(stage, json, n, from, err);
		if (ok)
			report(stage, eye, &w);
	}
	struct image *maps[] = { &w.clean, &w.thickness, &w.light, &w.sharp, &w.out };
	for (int i = 0; i < COUNT(maps); i++)
		image_free(maps[i]);
	for (int i = 0; i < INPUTS; i++)
		free(in[i]);
	free(out);
	free(json);
	return ok;
}
