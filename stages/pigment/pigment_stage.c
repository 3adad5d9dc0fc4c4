#include "stages/pigment/pigment_stage.h"

#include <math.h>
#include <stdlib.h>

#include "base/json.h"
#include "base/mem.h"
#include "image/exr.h"
#include "stages/pigment/find_white.h"
#include "tissue/relief/opts.h"
#include "tissue/rounds.h"

enum { MAP_LIMIT_PX = 1 << 26 };

/* An eye on its way. */
struct work {
	struct image clean, thickness;
	struct pupil pupil;
	struct found_white found;
	struct tissue_rounds_conf conf;  // as used: the view's cosine, the exposure's prior
	struct tissue_rounds rounds;
};

const char *const pigment_orders[] = { "single", "multiple", 0 }, *const pigment_whites[] = { "sclera", "card", "camera", 0 };

bool pigment_stage_check(struct pigment_stage_conf *c, struct err *err)
{
	c->fit.illuminant = (enum illuminant)c->illuminant;
	c->fit.multiple = c->order == 1;
	c->relief.filter = true;
	if (!(c->classes.outer > c->classes.inner))
		return err_set(err, "pigment.outer = %g: must be above pigment.inner = %g", c->classes.outer, c->classes.inner);
	if (!(c->white.outer > c->white.inner))
		return err_set(err, "pigment.sclera_outer = %g: must be above pigment.sclera_inner = %g", c->white.outer, c->white.inner);
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
	return relief_conf_check(&c->relief, c->range, err);
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

static char *extra_json(const struct work *w)
{
	json_t *out = json_object(), *white = json_object();
	json_object_set_new(white, "source", json_string(white_names[w->found.white.source]));
	json_object_set_new(white, "photo", json_string(w->found.photo ? w->found.photo : ""));
	json_object_set_new(white, "rgb", json_numbers(3, w->found.white.rgb));
	json_object_set_new(white, "share", json_number(w->found.white.share));
	json_object_set_new(white, "spread", json_number(w->found.white.spread));
	json_object_set_new(out, "white", white);
	json_object_set_new(out, "rounds", json_integer(w->rounds.n));
	json_object_set_new(out, "residual_by_round", json_numbers(w->rounds.n, w->rounds.residual));
	json_object_set_new(out, "relief_by_round", json_numbers(w->rounds.n, w->rounds.relief));
	json_object_set_new(out, "note", json_string("thickness_scale times thickness against melanin, and exposure against all of them, are what one "
	                                               "photograph tells least apart: see held_by_priors and correlation"));
	char *text = json_dumps(out, 0);
	json_decref(out);
	return text;
}

static void report(struct stage *stage, const struct capture_eye *eye, const struct work *w)
{
	const struct pigment_fit *f = &w->rounds.fit;
	const double *x = f->x;
	stage_note(stage, "%s: border layer melanin %.2f %% (eumelanin %.0f %%), stroma %.2f %% (%.0f %%), scale %.2f, exposure %.2f",
	           eye->side, 100 * exp(x[PIGMENT_ABL_MELANIN]), 100 * x[PIGMENT_ABL_RATIO], 100 * exp(x[PIGMENT_STROMA_MELANIN]),
	           100 * x[PIGMENT_STROMA_RATIO], exp(x[PIGMENT_SCALE]), exp(x[PIGMENT_EXPOSURE]));
	stage_note(stage, "%s: white from the %s, %d round%s, %d of %d starts' minima differ, residual %.0f %%, of colour alone %.0f %%", eye->side,
	           white_names[w->found.white.source], w->rounds.n, w->rounds.n > 1 ? "s" : "", f->minima - 1, f->starts, 100 * f->residual, 100 * f->residual_colour);
	stage_figure(stage, "residual", 100 * f->residual, "%");
	stage_figure(stage, "residual_colour", 100 * f->residual_colour, "%");
	stage_figure(stage, "abl_melanin", 100 * exp(x[PIGMENT_ABL_MELANIN]), "%");
	stage_figure(stage, "stroma_melanin", 100 * exp(x[PIGMENT_STROMA_MELANIN]), "%");
	stage_figure(stage, "rounds", w->rounds.n, "");
	stage_figure(stage, "minima", f->minima, "");
	stage_figure(stage, "held_by_priors", f->directions, "of 9 directions");
	if (w->found.white.source == WHITE_CAMERA)
		stage_skipped(stage, "%s: no white taken from the photograph: too little sclera beside the iris. Show more of the white of "
		              "the eye, or a grey card (photo.NAME.card_px)", eye->side);
}

/* White, then pigment and relief. */
static bool compute(struct work *w, char *const own[3], struct stage *stage, const struct capture *capture, int eye, const struct eye *anatomy,
                    const struct pigment_stage_conf *c, struct err *err)
{
	static const char *const rgbw[] = { "R", "G", "B", "W" }, *const thickness[] = { "Y" };
	struct exr_info info = { 0 };
	if (!exr_read(&w->clean, stage_path(stage, "%s", own[0]), 4, rgbw, MAP_LIMIT_PX, &info, err)
	    || !exr_read(&w->thickness, stage_path(stage, "%s", own[1]), 1, thickness, MAP_LIMIT_PX, 0, err)
	    || !pupil_load(&w->pupil, stage_path(stage, "%s", own[2]), c->pupil_radius, err)
	    || !find_white(&w->found, stage, capture, eye, anatomy, c, err))
		return false;
	w->conf = (struct tissue_rounds_conf){ c->fit, c->classes, c->relief, c->rounds, c->gain_min };
	w->conf.pigment.cos_view = w->found.cos_view;
	double *exposure = w->conf.pigment.prior[PIGMENT_EXPOSURE];
	if (w->found.white.source == WHITE_CAMERA)
		exposure[1] = hypot(exposure[1], c->white_unknown);
	struct tissue_maps maps = { &w->clean, &w->thickness, info.extent_mm, &w->pupil, anatomy->limbus_radius + c->root_beyond_limbus,
		                        { w->found.white.rgb[0], w->found.white.rgb[1], w->found.white.rgb[2] } };
	bool ok = tissue_rounds(&w->rounds, &maps, &w->conf, stage, err);
	stage_figure(stage, "rounds_left_out", c->rounds - w->rounds.n, "that would have changed nothing more");
	return ok;
}

bool pigment_stage(struct stage *stage, const struct capture *capture, int i, const struct eye *anatomy,
                   const struct pigment_stage_conf *conf, struct err *err)
{
	const struct capture_eye *eye = &capture->eyes[i];
	char *own[3], *out = mem_printf("%s/pigment.json", eye->iris), *extra = 0;
	const char **in = mem_new(3 + 2 * (size_t)capture->n_photos, sizeof *in);
	int n = inputs(in, own, capture, i);
	struct work w = { 0 };
	bool ok = stage_fresh(stage, out, n, in);
	if (!ok) {
		ok = compute(&w, own, stage, capture, i, anatomy, conf, err);
		extra = ok ? extra_json(&w) : 0;
		ok = ok
		     && pigment_save(&w.rounds.fit, &w.rounds.classes, &w.conf.pigment, stage_path(stage, "%s", out), stage_made_by(stage, n, in), extra,
		                     err)
		     && stage_made(stage, out, n, in, err);
		if (ok)
			report(stage, eye, &w);
	}
	image_free(&w.clean);
	image_free(&w.thickness);
	for (int k = 0; k < 3; k++)
		free(own[k]);
	free(in);
	free(out);
	free(extra);
	return ok;
}
