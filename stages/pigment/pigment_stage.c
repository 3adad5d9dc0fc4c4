#include "stages/pigment/pigment_stage.h"

#include <math.h>
#include <stdlib.h>

#include "base/json.h"
#include "base/mem.h"
#include "tissue/relief/opts.h"
#include "image/exr.h"
#include "stages/pigment/pigment_run.h"

enum { MAP_LIMIT_PX = 1 << 26 };
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

static char *extra_json(const struct pigment_run *run)
{
	json_t *out = json_object(), *white = json_object();
	json_object_set_new(white, "source", json_string(white_names[run->white.source]));
	json_object_set_new(white, "photo", json_string(run->white_photo ? run->white_photo : ""));
	json_object_set_new(white, "rgb", json_numbers(3, run->white.rgb));
	json_object_set_new(white, "share", json_number(run->white.share));
	json_object_set_new(white, "spread", json_number(run->white.spread));
	json_object_set_new(out, "white", white);
	json_object_set_new(out, "rounds", json_integer(run->rounds));
	json_object_set_new(out, "residual_by_round", json_numbers(run->rounds, run->residual));
	json_object_set_new(out, "relief_by_round", json_numbers(run->rounds, run->relief));
	json_object_set_new(out, "note", json_string(run->note));
	char *text = json_dumps(out, 0);
	json_decref(out);
	return text;
}

static void report(struct stage *stage, const struct capture_eye *eye, const struct pigment_run *run)
{
	const struct pigment_fit *f = &run->fit;
	const double *x = f->x;
	stage_note(stage, "%s: border layer melanin %.2f %% (eumelanin %.0f %%), stroma %.2f %% (%.0f %%), scale %.2f, exposure %.2f",
	           eye->side, 100 * exp(x[PIGMENT_ABL_MELANIN]), 100 * x[PIGMENT_ABL_RATIO], 100 * exp(x[PIGMENT_STROMA_MELANIN]),
	           100 * x[PIGMENT_STROMA_RATIO], exp(x[PIGMENT_SCALE]), exp(x[PIGMENT_EXPOSURE]));
	stage_note(stage, "%s: white from the %s, %d round%s, %d of %d starts' minima differ, residual %.0f %%, of colour alone %.0f %%", eye->side,
	           white_names[run->white.source], run->rounds, run->rounds > 1 ? "s" : "", f->minima - 1, f->starts, 100 * f->residual, 100 * f->residual_colour);
	stage_figure(stage, "residual", 100 * f->residual, "%");
	stage_figure(stage, "residual_colour", 100 * f->residual_colour, "%");
	stage_figure(stage, "abl_melanin", 100 * exp(x[PIGMENT_ABL_MELANIN]), "%");
	stage_figure(stage, "stroma_melanin", 100 * exp(x[PIGMENT_STROMA_MELANIN]), "%");
	stage_figure(stage, "rounds", run->rounds, "");
	stage_figure(stage, "minima", f->minima, "");
	stage_figure(stage, "held_by_priors", f->directions, "of 9 directions");
	if (run->white.source == WHITE_CAMERA)
		stage_skipped(stage, "%s: no white taken from the photograph: too little sclera beside the iris. Show more of the white of "
		              "the eye, or a grey card (photo.NAME.card_px)", eye->side);
}

bool pigment_stage(struct stage *stage, const struct capture *capture, int i, const struct eye *anatomy,
                   const struct pigment_stage_conf *conf, struct err *err)
{
	const struct capture_eye *eye = &capture->eyes[i];
	char *own[3], *out = mem_printf("%s/pigment.json", eye->iris), *extra = 0;
	const char **in = mem_new(3 + 2 * (size_t)capture->n_photos, sizeof *in);
	int n = inputs(in, own, capture, i);
	struct pigment_run run = { .capture = capture, .eye = i, .stage = stage, .anatomy = anatomy };
	bool ok = stage_fresh(stage, out, n, in);
	if (!ok) {
		static const char *const rgbw[] = { "R", "G", "B", "W" }, *const thickness[] = { "Y" };
		struct exr_info info = { 0 };
		ok = exr_read(&run.clean, stage_path(stage, "%s", own[0]), 4, rgbw, MAP_LIMIT_PX, &info, err)
		     && exr_read(&run.thickness, stage_path(stage, "%s", own[1]), 1, thickness, MAP_LIMIT_PX, 0, err)
		     && pupil_load(&run.pupil, stage_path(stage, "%s", own[2]), conf->pupil_radius, err);
		run.extent = info.extent_mm;
		ok = ok && pigment_run(&run, conf, err);
		extra = ok ? extra_json(&run) : 0;
		ok = ok && pigment_save(&run.fit, &run.classes, &run.conf, stage_path(stage, "%s", out), stage_made_by(stage, n, in), extra, err)
		     && stage_made(stage, out, n, in, err);
		if (ok)
			report(stage, eye, &run);
	}
	pigment_run_free(&run);
	for (int k = 0; k < 3; k++)
		free(own[k]);
	free(in);
	free(out);
	free(extra);
	return ok;
}
