#include "stages/pigment/pigment_run.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/json.h"

/* What brought this photograph's colour to the texture's: texture.json's "gain"; false when it was not used there. */
static bool texture_gain(double gain[3], const json_t *texture, const char *name)
{
	size_t i;
	json_t *photo;
	gain[0] = gain[1] = gain[2] = 1;
	json_array_foreach(json_object_get(texture, "photos"), i, photo) {
		const char *is = json_string_value(json_object_get(photo, "name"));
		struct err unread = { 0 };
		if (is && !strcmp(is, name)) {
			json_get_array(gain, 3, photo, "gain", "", &unread);
			return !json_is_false(json_object_get(photo, "used"));
		}
	}
	return true;
}

/* The white of one photograph. False, with no error, when it has none. */
static bool look(struct white *white, double *cos_view, struct pigment_run *run, const struct capture_photo *p,
                 const struct pigment_stage_conf *c, struct err *err)
{
	struct fit fit;
	struct photo photo = { 0 };
	const struct opt_each *card = capture_each(&c->card, p->name);
	if (!fit_load(&fit, stage_path(run->stage, "%s", p->fit), err))
		return false;
	double inside = sin(fit.theta) / run->anatomy->index;
	*cos_view = sqrt(1 - inside * inside);
	if (!fit.ok || !photo_load(&photo, stage_path(run->stage, "%s", p->file), c->limit_mpx, err))
		return false;
	bool ok = false;
	if (card && c->white_from != WHITE_FROM_CAMERA)
		ok = white_card(white, &photo, card->value, &c->white, err) || err_wrap(err, "%s", p->file);
	else if (c->white_from == WHITE_FROM_SCLERA)
		ok = white_sclera(white, &photo, &fit, &c->white);
	photo_free(&photo);
	return ok;
}

/* The best white among the eye's photographs: a card before sclera, more sclera before less; in the texture's colours.
 * Photographs that were left out of the texture tell nothing. */
static bool find_white(struct pigment_run *run, const struct pigment_stage_conf *c, struct err *err)
{
	json_t *texture = json_read(stage_path(run->stage, "%s/texture.json", run->capture->eyes[run->eye].iris), 1 << 22, err);
	if (!texture)
		return false;
	run->white = white_camera();
	double view = 0;
	int views = 0;
	for (int i = 0; i < run->capture->n_photos && !err_is(err); i++) {
		const struct capture_photo *p = &run->capture->photos[i];
		double gain[3], cos_view = 1;
		struct white white;
		if (p->eye != run->eye || !texture_gain(gain, texture, p->name))
			continue;
		struct err fault = { 0 };
		bool ok = look(&white, &cos_view, run, p, c, &fault);
		if (err_is(&fault)) {
			stage_warn(run->stage, "white: %s", fault.msg);
			continue;
		}
		view += cos_view;
		views++;
		if (!ok || white.source < run->white.source || (white.source == run->white.source && white.share <= run->white.share))
			continue;
		run->white = white;
		run->white_photo = p->name;
		for (int k = 0; k < 3; k++)
			run->white.rgb[k] *= gain[k];
	}
	json_decref(texture);
	run->conf.cos_view = views ? view / views : 1;
	return !err_is(err);
}

/* One round: classes, pigment, and the relief that follows. next: thickness after the filter. */
static bool turn(struct pigment_run *run, struct image *next, const struct image *thickness, const struct pigment_stage_conf *c,
                 struct err *err)
{
	double root = run->anatomy->limbus_radius + c->root_beyond_limbus;
	struct relief_fit relief;
	struct pigment_fit first = run->fit;
	if (!pigment_classify(&run->classes, &run->clean, thickness, run->extent, &run->pupil, root, run->white.rgb, &c->classes, err)
	    || !pigment_solve(&run->fit, &run->classes, &run->conf, run->rounds ? first.x : 0, err)
	    || !relief_solve(&relief, &run->clean, &run->thickness, run->extent, &run->pupil, root, run->white.rgb, run->fit.x,
	                     &run->conf, &c->relief, err))
		return false;
	if (run->rounds) {  // what the several starts of the first round found stays said
		run->fit.starts = first.starts;
		run->fit.minima = first.minima;
		memcpy(run->fit.other, first.other, sizeof first.other);
	}
	run->residual[run->rounds] = run->fit.residual;
	run->relief[run->rounds++] = relief.after;
	return relief_apply(next, &run->thickness, run->extent, &relief, &c->relief, err);
}

bool pigment_run(struct pigment_run *run, const struct pigment_stage_conf *c, struct err *err)
{
	run->conf = c->fit;
	if (!find_white(run, c, err))
		return false;
	if (run->white.source == WHITE_CAMERA)
		run->conf.prior[PIGMENT_EXPOSURE][1] = hypot(run->conf.prior[PIGMENT_EXPOSURE][1], c->white_unknown);
	struct image thickness = { 0 };
	bool ok = true, pays = true;
	while (ok && pays && run->rounds < c->rounds && run->rounds < PIGMENT_ROUNDS_MAX) {
		struct image next = { 0 };
		ok = turn(run, &next, thickness.px ? &thickness : &run->thickness, c, err);
		image_free(&thickness);
		thickness = next;
		int r = run->rounds;
		double before = r > 1 ? run->residual[r - 2] + run->relief[r - 2] : INFINITY, now = ok ? run->residual[r - 1] + run->relief[r - 1] : 0;
		pays = now < (1 - c->gain_min) * before;
		stage_progress(run->stage, r, c->rounds, "pigment and relief");
	}
	stage_figure(run->stage, "rounds_left_out", c->rounds - run->rounds, "that would have changed nothing more");
	image_free(&thickness);
	snprintf(run->note, sizeof run->note, "thickness_scale times thickness against melanin, and exposure against all of them, are what one "
	         "photograph tells least apart: see held_by_priors and correlation");
	return ok;
}

void pigment_run_free(struct pigment_run *run)
{
	image_free(&run->clean);
	image_free(&run->thickness);
}
