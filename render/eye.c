/* The pictures of one eye: made only where they are not fresh, from one scene that is loaded when the first is needed (job.c). */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "base/json.h"
#include "base/mem.h"
#include "draw/eye/converge.h"
#include "draw/photo/lids.h"
#include "draw/studio.h"
#include "render/render.h"

static double now_s(void)
{
	struct timespec t;
	clock_gettime(CLOCK_MONOTONIC, &t);
	return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static struct image trace(struct job *job, struct scene_view *view, const struct scene_lighting *light)
{
	double start = now_s();
	view->samples = job->conf->samples;
	int passes = job->conf->passes;
	struct image image = passes > 1 ? scene_converge(&job->scene, view, light->env, light->mirror, job->conf->lights, passes, &job->error, &job->count)
	                                : scene_render(&job->scene, view, light, &job->count);
	job->seconds += now_s() - start;
	return image;
}

/* Renders the eye turned by yaw and pitch (degrees) in the studio; view: out. */
static struct image turned(struct job *job, struct scene_view *view, double yaw, double pitch, int size, bool mirror)
{
	struct scene_lighting light = scene_lighting_of(&job->studio, mirror ? &job->studio : 0, job->conf->lights, job->conf->light_directions);
	*view = scene_view_turned(&job->scene, yaw * M_PI / 180, pitch * M_PI / 180, job->conf->field_mm, size);
	return trace(job, view, &light);
}

static const char *output(struct job *job, const char *name, const char *suffix)
{
	return stage_path(job->stage, "%s/%s%s", job->names->render, name, suffix) + strlen(job->stage->capture) + 1;
}

static bool stale(struct job *job, const char *rel, int n, const char *const in[])
{
	return !stage_fresh(job->stage, rel, n, in);
}

static bool still(struct job *job, const char *name, double yaw, double pitch, struct err *err)
{
	const char *png = output(job, name, ".png"), *exr = output(job, name, ".exr"), *layers = output(job, name, "_layers.exr");
	bool need_png = stale(job, png, job->n_in, job->in);
	bool need_exr = job->conf->exr && (stale(job, exr, job->n_in, job->in) || stale(job, layers, job->n_in, job->in));
	if (!need_png && !need_exr)  // one look makes all
		return true;
	if (!job_ready(job, err))
		return false;
	struct scene_view view;
	struct image rgba = turned(job, &view, yaw, pitch, job->conf->size_px, true), seen = studio_on_grey(&rgba, job->gain, &job->conf->finish);
	const struct picture_out out[] = { { png, &seen }, { exr, &rgba } };
	bool ok = pictures_save(job, job->conf->exr ? 2 : 1, out, job->n_in, job->in, err);
	if (ok && job->conf->exr) {
		struct image diffuse = turned(job, &view, yaw, pitch, job->conf->size_px, false);
		ok = layers_save(job, layers, &rgba, &diffuse, &view, err);
		image_free(&diffuse);
	}
	image_free(&rgba);
	image_free(&seen);
	return ok;
}

static bool turntable(struct job *job, struct err *err)
{
	const char *png = output(job, "turntable", ".png");
	int n = job->conf->frames;
	if (!stale(job, png, job->n_in, job->in))
		return true;
	if (!job_ready(job, err))
		return false;
	struct image *frames = mem_new((size_t)n, sizeof *frames);
	for (int i = 0; i < n; i++) {
		double yaw = n > 1 ? job->conf->frame_deg * (2.0 * i / (n - 1) - 1) : 0;
		struct scene_view view;
		struct image rgba = turned(job, &view, yaw, 0, job->conf->frame_px, true);
		frames[i] = studio_on_grey(&rgba, job->gain, &job->conf->finish);
		image_free(&rgba);
	}
	struct image strip = sheet_strip(n, frames);
	bool ok = pictures_save(job, 1, &(struct picture_out){ png, &strip }, job->n_in, job->in, err);
	for (int i = 0; i < n; i++)
		image_free(&frames[i]);
	free(frames);
	image_free(&strip);
	return ok;
}

/* As the photograph's light, whose lamps the cornea mirrors, colours it. */
static struct image traced_in_photo(struct job *job, const struct shot *shot, struct scene_view *view)
{
	struct envmap lamps = { 0 };
	if (shot->n_lamps)
		lamps = shot_mirrored(&shot->lamps, &job->scene);
	// The even reflection of the room is part of the texture; only the lamps, which the texture leaves out, are mirrored.
	struct scene_lighting light = scene_lighting_of(&shot->env, shot->n_lamps ? &lamps : 0, job->conf->lights, job->conf->light_directions);
	struct image rgba = trace(job, view, &light);
	shot_colour(&rgba, &job->scene);
	shot_lids(&rgba, shot, &job->scene.eye);
	envmap_free(&lamps);
	return rgba;
}

/* The same view by the fitted model alone: what the photograph's own detail hides. */
static struct shot_difference by_model(struct job *job, const struct shot *shot, struct scene_view *view)
{
	const double detail = job->scene.conf.detail;
	scene_set_detail(&job->scene, 0);
	struct image rgba = traced_in_photo(job, shot, view), seen = studio_on_grey(&rgba, 1, &(struct studio_finish){ 0 });
	const struct shot_difference out = compare_numbers(&job->scene, shot, &seen);
	scene_set_detail(&job->scene, detail);
	image_free(&rgba);
	image_free(&seen);
	return out;
}

static json_t *figures_of(const struct job *job, const struct shot *shot, const struct shot_difference *differs, const struct shot_difference *model)
{
	json_t *out = json_object();
	if (differs->n) {
		json_object_set_new(out, "difference_mean", json_real(differs->mean));
		json_object_set_new(out, "difference_95", json_real(differs->high));
		json_object_set_new(out, "model_difference_mean", json_real(model->mean));
		json_object_set_new(out, "model_difference_95", json_real(model->high));
		json_object_set_new(out, "difference", json_string("CIEDE2000"));
		stage_note(job->stage, "%s: differs from the photograph by %.2f on average, %.2f at 95 %% (CIEDE2000); the model alone by %.2f",
		           shot->photo->name, differs->mean, differs->high, model->mean);
	}
	// Under another light than the one that the colours were read in, how the model answers to light shows beside the photograph's own detail.
	json_object_set_new(out, "colours_from", json_string(job->shots[job->reference].photo->name));
	json_object_set_new(out, "compared_px", json_integer(differs->n));
	json_object_set_new(out, "exposure", json_real(job->scene.gain));
	json_object_set_new(out, "explained_by_model", json_real(job->scene.explained));
	json_object_set_new(out, "lamps", json_integer(shot->n_lamps));
	return out;
}

static bool photo_view(struct job *job, struct shot *shot, struct err *err)
{
	const char *in[COUNT(job->in) + 2];
	int n = job->n_in;
	memcpy(in, job->in, sizeof job->in);
	in[n++] = shot->photo->fit;
	in[n++] = shot->photo->file;
	const char *png = output(job, shot->photo->name, "_view.png"), *exr = output(job, shot->photo->name, "_view.exr");
	const char *compare = output(job, shot->photo->name, "_compare.png");
	const char *numbers = output(job, shot->photo->name, "_compare.json");
	bool need_exr = job->conf->exr && stale(job, exr, n, in), need_png = stale(job, png, n, in);
	bool need_compare = stale(job, compare, n, in), need_numbers = stale(job, numbers, n, in);
	if (!need_exr && !need_png && !need_compare && !need_numbers)
		return true;
	if (!job_ready(job, err) || !shot_ready(job, shot, err))
		return false;
	struct scene_view view = shot_view(shot);
	struct shot_difference differs;
	struct image rgba = traced_in_photo(job, shot, &view), seen = studio_on_grey(&rgba, 1, &(struct studio_finish){ 0 });
	struct image beside = compare_shot(&differs, &job->scene, shot, &seen);
	const struct shot_difference model = by_model(job, shot, &view);
	json_t *figures = figures_of(job, shot, &differs, &model);
	const struct picture_out out[] = { { png, &seen }, { compare, &beside }, { exr, &rgba } };
	bool ok = pictures_save(job, job->conf->exr ? 3 : 2, out, n, in, err)
	          && json_write(stage_path(job->stage, "%s", numbers), figures, stage_made_by(job->stage, n, in), err)
	          && stage_made(job->stage, numbers, n, in, err);
	job->worst = fmax(job->worst, json_number_value(json_object_get(figures, "difference_mean")));
	job->worst_model = fmax(job->worst_model, json_number_value(json_object_get(figures, "model_difference_mean")));
	json_decref(figures);
	image_free(&rgba);
	image_free(&seen);
	image_free(&beside);
	return ok;
}

static bool pictures(struct job *job, struct err *err)
{
	int total = job->n_shots + 3, done = 0;
	for (int i = 0; i < job->n_shots; i++) {
		if (!photo_view(job, &job->shots[i], err))
			return false;
		if (i != job->reference)
			shot_done(&job->shots[i]);
		stage_progress(job->stage, ++done, total, "pictures");
	}
	if (!asked_pictures(job, err) || !still(job, "front", 0, 0, err))
		return false;
	stage_progress(job->stage, ++done, total, "pictures");
	if (!still(job, "three_quarter", job->conf->three_quarter_deg[0], job->conf->three_quarter_deg[1], err))
		return false;
	stage_progress(job->stage, ++done, total, "pictures");
	return turntable(job, err) && turntable_film(job, output(job, "turntable", ".mp4"), err);
}

static void figures(struct job *job)
{
	if (!job->seconds)
		return;
	if (job->worst > 0) {
		stage_figure(job->stage, "difference_from_photograph", job->worst, "CIEDE2000, mean inside the iris, the worst photograph");
		stage_figure(job->stage, "difference_of_model", job->worst_model, "the same of the fitted model alone, which judges the fit");
	}
	stage_figure(job->stage, "rays", (double)job->count.rays / 1e6, "million");
	stage_figure(job->stage, "rays_left_out", (double)(job->count.kept + job->count.hidden) / 1e6, "million: hidden, or known from the picture before");
	if (job->conf->passes > 1)
		stage_figure(job->stage, "noise", 100 * job->error, "% of luminance, standard error of the last picture");
	stage_figure(job->stage, "tracing", job->seconds, "s");
	stage_figure(job->stage, "speed", (double)job->count.rays / job->seconds / 1e6, "million rays a second");
	stage_note(job->stage, "%.1f million rays, %.2f s, %.1f million a second", (double)job->count.rays / 1e6, job->seconds,
	           (double)job->count.rays / job->seconds / 1e6);
}

bool render_eye(struct job *job, struct err *err)
{
	bool ok = true;
	if (job->usable) {
		ok = pictures(job, err);
		figures(job);
	} else if (!job->n_shots) {
		stage_skipped(job->stage, "pictures of %s: no photograph of it has a fit", job->names->side);
	} else {
		stage_skipped(job->stage, "pictures of %s: %s is missing", job->names->side, job->in[0]);
	}
	return ok && !err_is(err);
}
