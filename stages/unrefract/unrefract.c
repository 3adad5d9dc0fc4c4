#include "unrefract.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "bridge/cv_photo.h"
#include "image/exr.h"
#include "limbus/evidence.h"
#include "limbus/occlusion.h"

/* The photographs of one eye whose limbus was found. */
struct work {
	const struct run *run;
	const struct capture_eye *eye;
	int n;
	const struct capture_photo **photos;  // [n]
	struct fit *fits;                     // [n]
	const struct capture_photo **fellows; // [n]: the other eye in the same photograph, where this one's pupil was not measured; else null
	struct unrefract_view *views;         // [n]
	int n_inputs;
	const char **inputs;                  // photographs and fits; also fits that are not ok: a change may make them usable
	struct evidence_net *net;
	struct occlusion_net *occlusion;
	struct photo kept;                    // a single photograph stays in memory between survey and merge
};

static bool load_photo(struct photo *photo, const struct work *w, int i, struct err *err)
{
	return photo_load(photo, stage_path(w->run->stage, "%s", w->photos[i]->file), w->run->limit_mpx, err);
}

/* Fits that are there and ok. */
static void gather(struct work *w, int index)
{
	const struct capture *capture = w->run->capture;
	size_t n = (size_t)capture->n_photos;
	w->photos = mem_new(n, sizeof *w->photos);
	w->fits = mem_new(n, sizeof *w->fits);
	w->views = mem_new(n, sizeof *w->views);
	w->fellows = mem_new(n, sizeof *w->fellows);
	w->inputs = mem_new(3 * n, sizeof *w->inputs);
	for (int i = 0; i < capture->n_photos; i++) {
		const struct capture_photo *photo = &capture->photos[i];
		struct err err = { 0 };
		if (photo->eye != index)
			continue;
		struct fit *fit = &w->fits[w->n];
		w->inputs[w->n_inputs++] = photo->fit;
		if (!fit_load(fit, stage_path(w->run->stage, "%s", photo->fit), &err)) {
			stage_warn(w->run->stage, "%s: left out: %s", photo->file, err.msg);
		} else if (!fit->ok) {
			stage_skipped_as_said(w->run->stage, "%s: %s", photo->file, fit->reason);
		} else {
			w->inputs[w->n_inputs++] = photo->file;
			w->fellows[w->n] = fit->has_pupil ? 0 : capture_fellow(capture, photo);
			if (w->fellows[w->n])
				w->inputs[w->n_inputs++] = w->fellows[w->n]->fit;
			w->views[w->n].name = photo->name;
			w->photos[w->n++] = photo;
		}
	}
}

/* What the network tells of this eye; null where it cannot be run on it: the photograph tells less then. */
static const struct evidence *evidence_of(struct evidence *out, const struct work *w, const struct photo *photo, const struct fit *fit)
{
	struct err err = { 0 };
	if (evidence_window(out, w->net, photo, fit->limbus.cx, fit->limbus.cy, fit->limbus.a, &err))
		return out;
	stage_warn(w->run->stage, "%s", err.msg);
	return 0;
}

/* What hides this eye; null where it cannot be told, err is set. free(). */
static struct occlusion *occlusion_of(const struct work *w, const struct photo *photo, const struct evidence *told, const struct fit *fit, struct err *err)
{
	struct occlusion *hidden = mem_new(1, sizeof *hidden);
	if (occlusion_read(hidden, w->occlusion, photo, told, &fit->limbus, err))
		return hidden;
	free(hidden);
	return 0;
}

/* What the other eye tells of this one's pupil; nothing where it has no usable limbus. */
static struct pupil_curve fellow_of(const struct work *w, const struct photo *photo, const struct capture_photo *other)
{
	struct pupil_curve curve = { 0 };
	struct evidence evidence = { 0 };
	struct fit fit;
	struct err err = { 0 };
	if (!other || !fit_load(&fit, stage_path(w->run->stage, "%s", other->fit), &err) || !fit.ok)
		return curve;
	const struct evidence *told = fit.has_pupil ? 0 : evidence_of(&evidence, w, photo, &fit);
	struct occlusion *hidden = told ? occlusion_of(w, photo, told, &fit, &err) : 0;
	if ((told && !hidden) || !unrefract_pupil(&curve, photo, &fit, told, hidden, w->run->eye, w->run->conf, &err))
		stage_warn(w->run->stage, "%s: tells nothing of the other eye's pupil: %s", other->name, err.msg);
	evidence_free(&evidence);
	free(hidden);
	return curve;
}

/* White, lids, reflections of photograph i. */
static bool look(struct work *w, int i, const struct photo *photo, struct err *err)
{
	struct unrefract_view *view = &w->views[i];
	const struct fit *fit = &w->fits[i];
	struct evidence evidence = { 0 };
	const struct evidence *told = evidence_of(&evidence, w, photo, fit);
	const struct pupil_curve fellow = fellow_of(w, photo, w->fellows[i]);
	struct occlusion *hidden = told ? occlusion_of(w, photo, told, fit, err) : 0;
	view->occlusion = hidden;
	if (!photo->grey)
		view->white = balance_sclera(photo, fit, told, w->run->white);
	bool ok = (hidden || !told) && unrefract_survey(view, photo, fit, told, &fellow, w->run->eye, w->run->conf, err);
	evidence_free(&evidence);
	view->occlusion = 0;
	free(hidden);
	return ok;
}

static void survey(struct work *w)
{
	for (int i = 0; i < w->n; i++) {
		struct photo photo = { 0 };
		struct err err = { 0 };
		struct unrefract_view *view = &w->views[i];
		stage_progress(w->run->stage, i, 2 * w->n, "survey");
		if (!load_photo(&photo, w, i, &err) || !look(w, i, &photo, &err)) {
			snprintf(view->note, sizeof view->note, "%.150s", err.msg);
			stage_warn(w->run->stage, "%s: left out: %s", w->photos[i]->file, err.msg);
		}
		if (w->n == 1)
			w->kept = photo;
		else
			photo_free(&photo);
	}
}

static bool merge(struct unrefract_texture *texture, struct work *w, int best, struct err *err)
{
	const struct run *run = w->run;
	int size = unrefract_size(w->n, w->views, run->eye, run->conf);
	*texture = unrefract_begin(size, run->eye, &w->views[best], run->conf);
	for (int i = 0; i < w->n; i++) {
		stage_progress(run->stage, w->n + i, 2 * w->n, "merge");
		struct photo photo = w->kept;
		if (!w->views[i].used)
			continue;
		if (!photo.rgb && !load_photo(&photo, w, i, err))
			return false;
		unrefract_add(texture, &w->views[i], &photo, run->eye, run->conf);
		if (!w->kept.rgb)
			photo_free(&photo);
	}
	unrefract_finish(texture, run->eye);
	unrefract_fill(texture, run->eye);
	stage_progress(run->stage, 2 * w->n, 2 * w->n, "merge");
	return true;
}

static bool save(const struct unrefract_texture *texture, struct work *w, const char *exr, const char *json,
                 struct err *err)
{
	static const char *const channels[] = { "R", "G", "B", "W" };
	struct stage *stage = w->run->stage;
	int n = w->n_inputs;
	const char *made_by = stage_made_by(stage, n, w->inputs);
	struct exr_info info = { texture->extent, made_by };
	return exr_write(stage_path(stage, "%s", exr), &texture->rgbw, channels, EXR_HALF, &info, err)
	       && unrefract_save_json(stage_path(stage, "%s", json), texture, w->n, w->views, made_by, err)
	       && stage_made(stage, exr, n, w->inputs, err) && stage_made(stage, json, n, w->inputs, err);
}

static void tell(const struct unrefract_texture *texture, const struct work *w)
{
	struct stage *stage = w->run->stage;
	int used = 0;
	for (int i = 0; i < w->n; i++) {
		used += w->views[i].used;
		if (!w->views[i].used)
			stage_skipped(stage, "%s: %s", w->photos[i]->file, w->views[i].note);
	}
	stage_figure(stage, "texels a side", texture->rgbw.width, "");
	stage_figure(stage, "texels computed", (double)texture->texels, "");
	stage_figure(stage, "texels_left_out", fmax((double)used * texture->rgbw.width * texture->rgbw.width - (double)texture->texels, 0),
	             "of the photographs: outside the iris, or not seen");
	stage_figure(stage, "texels per mm", texture->rgbw.width / (2 * texture->extent), "/mm");
	stage_figure(stage, "iris seen", 100 * texture->seen, "%");
	stage_figure(stage, "photographs merged", used, "");
	char spread[32] = "";
	if (texture->pupil_sigma > 0)
		snprintf(spread, sizeof spread, " +- %.2f", 2 * texture->pupil.r * texture->pupil_sigma);
	stage_note(stage, "%s: %d x %d texels of %d photograph%s, %.1f %% of the iris seen, pupil %.2f%s mm", w->eye->iris,
	           texture->rgbw.width, texture->rgbw.width, used, used == 1 ? "" : "s", 100 * texture->seen,
	           2 * texture->pupil.r, spread);
}

static bool make(struct work *w, const char *exr, const char *json, struct err *err)
{
	struct stage *stage = w->run->stage;
	if (stage_fresh(stage, exr, w->n_inputs, w->inputs) && stage_fresh(stage, json, w->n_inputs, w->inputs)
	    && !w->run->write_map)
		return true;
	if (!evidence_open_shipped(&w->net, err) || !occlusion_open_shipped(&w->occlusion, err)) {
		evidence_close(w->net);
		return false;
	}
	survey(w);
	occlusion_close(w->occlusion);
	evidence_close(w->net);
	int best = unrefract_align(w->n, w->views, w->run->conf);
	if (!w->views[best].used)
		return err_set(err, "%s: %s", w->photos[best]->file, w->views[best].note);
	struct unrefract_texture texture = { 0 };
	bool ok = merge(&texture, w, best, err) && save(&texture, w, exr, json, err);
	if (ok)
		tell(&texture, w);
	for (int i = 0; ok && w->run->write_map && i < w->n; i++)
		ok = !w->views[i].used || unrefract_write_map(w->run, w->photos[i], &w->views[i], w->eye->iris, err);
	image_free(&texture.rgbw);
	return ok;
}

/* Whether a photograph of another eye has a usable limbus: then this eye is left out, and that one made. One that has a texture already is
 * not left out in silence with what its photographs no longer show. */
static bool others_usable(const struct run *run, int index)
{
	for (int i = 0; i < run->capture->n_photos; i++) {
		const struct capture_photo *photo = &run->capture->photos[i];
		struct fit fit;
		struct err err = { 0 };
		if (photo->eye != index && fit_load(&fit, stage_path(run->stage, "%s", photo->fit), &err) && fit.ok)
			return true;
	}
	return false;
}

bool unrefract_eye(const struct run *run, int index, struct err *err)
{
	struct work w = { .run = run, .eye = &run->capture->eyes[index] };
	gather(&w, index);
	char *exr = mem_printf("%s/texture.exr", w.eye->iris), *json = mem_printf("%s/texture.json", w.eye->iris);
	bool ok = w.n ? make(&w, exr, json, err) : !file_exists(stage_path(run->stage, "%s", exr)) && others_usable(run, index);
	if (!w.n && ok)
		stage_skipped(run->stage, "%s: none of its photographs has a usable limbus: see work/limbus", w.eye->iris);
	else if (!w.n)
		err_set(err, "no photograph of the %s%s has a usable limbus: see work/limbus, or say where the eye is with photo.NAME.hint_px",
		        w.eye->side, strcmp(w.eye->side, "eye") ? " eye" : "");
	for (int i = 0; i < w.n; i++)
		unrefract_view_free(&w.views[i]);
	photo_free(&w.kept);
	free(exr);
	free(json);
	free(w.photos);
	free(w.fits);
	free(w.fellows);
	free(w.views);
	free(w.inputs);
	return ok;
}
