#include "stages/calibrate/run.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/aside.h"
#include "base/mem.h"
#include "base/run.h"
#include "sfm/figure/figure.h"
#include "sfm/features.h"
#include "sfm/model.h"
#include "sfm/pairs.h"
#include "sfm/subject.h"
#include "stages/calibrate/kept.h"
#include "stages/calibrate/state.h"

#define RIG "work/rig.json"

/* The input files of the results; the video once, for all its frames. */
static const char **inputs_of(int *n, const struct views *views, const struct calibrate_options *o)
{
	const char **in = mem_new((size_t)views->n + 1, sizeof *in), *video = 0;
	*n = 0;
	for (int i = 0; i < views->n; i++) {
		const struct view *v = &views->v[i];
		if (v->frame < 0)
			in[(*n)++] = v->file;
		else
			video = v->file;
	}
	if (video)
		in[(*n)++] = video;
	if (o->template)
		in[(*n)++] = o->template;
	return in;
}

static void report(struct stage *stage, const struct views *views, const struct camera_rig *rig, const struct head *head)
{
	stage_note(stage, "%d cameras, %.2f px; %s scale; frame from %s", rig->n, head->residual_px, head->scale_source,
	           head->frame_source);
	stage_figure(stage, "views", views->n, "");
	stage_figure(stage, "registered", rig->n, "");
	stage_figure(stage, "points", head->model->n_points, "");
	stage_figure(stage, "residual", head->residual_px, "px");
	if (isfinite(head->scale_sigma))
		stage_figure(stage, "scale_sigma", 100 * head->scale_sigma, "%");
}

/* Rejects a model of a video's frames with fewer than half of them: a face that talks before a still camera deforms, and the few frames
 * in which it does so alike give a wrong model with a wrong lens. unfit: out: rejected. */
static bool is_believed(bool *unfit, const struct colmap_model *m, const struct views *views, const struct stage *stage, struct err *err)
{
	*unfit = views_are_video(views) && 2 * m->n_images < views->n_used;
	return !*unfit || err_set(err, "%s/views: %d of the video's %d frames alone fit together", stage->capture, m->n_images, views->n_used);
}

/* unfit: out: the pictures are at fault, and err says what to photograph instead. */
static bool from_views(bool *unfit, struct stage *stage, struct views *views, const struct calibrate_options *o, struct err *err)
{
	bool grows;
	struct colmap_model model = { 0 };
	struct head head = { .model = &model };
	struct camera_rig rig = { 0 };
	int n;
	const char **in = inputs_of(&n, views, o);
	const char *const rig_alone[] = { RIG };
	*unfit = false;
	// From here on the kept files belong to these options: an interrupted run can be resumed.
	bool ok = state_check(stage, o, err) && state_save(stage, o, err)
	          && kept_record(stage, views, false, err) && features_make(&grows, views, stage, o, err)
	          && pairs_match(views, stage, o, err) && model_make(&model, unfit, views, grows, stage, o, err)
	          && is_believed(unfit, &model, views, stage, err)
	          && kept_record(stage, views, false, err)
	          && head_place(&head, views, stage, o, err)
	          && kept_record(stage, views, false, err)
	          && rig_out(&rig, &head, views, stage_path(stage, RIG), stage_made_by(stage, n, in), err)
	          && stage_made(stage, RIG, n, in, err);
	if (ok && subject_given(stage))
		stage_skipped(stage, "subject mesh: the folder has one");
	else if (ok)
		// The mesh names the rig as its input, and that names all photographs: a PLY's header has to stay short.
		ok = subject_make(&head, views, stage, o, stage_made_by(stage, 1, rig_alone), err)
		     && (!file_exists(stage_path(stage, SUBJECT)) || stage_made(stage, SUBJECT, n, in, err));
	ok = ok && figure_draw(&head, &rig, stage, err) && stage_made(stage, FIGURE, n, in, err);
	ok = ok && kept_record(stage, views, true, err);
	if (ok)
		report(stage, views, &rig, &head);
	free(in);
	camera_rig_free(&rig);
	colmap_free(&model);
	return ok;
}

/* Records that the video gives no camera and puts older results aside: later stages then assume a generic camera. */
static bool give_up(struct stage *stage, const struct views *views, const char *why, struct err *err)
{
	static const char *const out[] = { RIG, SUBJECT, FIGURE };
	const char *file = "video/";
	for (int i = 0; i < views->n; i++)
		file = views->v[i].frame >= 0 ? views->v[i].file : file;
	stage_skipped(stage, "%s: no camera found from it (%s): a generic one is taken. Set camera.focal_px, or put photographs taken round the head into views/",
	              file, why);
	*err = (struct err){ 0 };
	// What was compared so far serves a next try.
	bool ok = kept_record(stage, views, true, err);
	for (int i = 0; i < COUNT(out); i++)
		ok = aside_put(stage->capture, out[i], err) && ok;
	return ok;
}

/* Checks the template's path before the long work, not after it. */
static bool check_template(struct stage *stage, const struct calibrate_options *o, struct err *err)
{
	char *path = 0;
	bool ok = !o->template || file_inside(&path, stage->capture, o->template, err) || err_wrap(err, "capture.conf: calibrate.template");
	free(path);
	return ok;
}

/* Says at once that COLMAP is missing, before any picture is read. A video alone goes on without it. */
static bool check_colmap(struct stage *stage, struct err *err)
{
	struct file_list list;
	if (run_exists("colmap") || !stage_list(stage, &list, "views", err))
		return !err_is(err);
	const int n = list.n;
	file_list_free(&list);
	return n < 2 || err_set(err, "colmap is not installed: apt-get install colmap; it finds the cameras of the %d photographs in views/", n);
}

bool calibrate_run(struct stage *stage, const struct calibrate_options *o, struct err *err)
{
	struct views views;
	bool unfit;
	if (!check_template(stage, o, err) || !check_colmap(stage, err) || !kept_check(stage, err))
		return false;
	bool ok = views_gather(&views, stage, o, err), video = ok && file_exists(stage_path(stage, "video")) && views_are_video(&views);
	if (ok && video && !run_exists("colmap"))
		ok = give_up(stage, &views, "COLMAP is not installed: apt-get install colmap", err);
	else if (ok && video && views.n_used < 2)
		ok = give_up(stage, &views, "it shows one picture only, or none", err);
	else if (ok && views.n_used < 2)
		ok = err_set(err, "%s/views: %d usable photographs, at least 2 are needed, better 20 from all round", stage->capture,
		             views.n_used);
	else if (ok)
		ok = from_views(&unfit, stage, &views, o, err)
		     || (video && unfit && give_up(stage, &views, "neither camera nor head move enough in it, or the face moves in itself", err));
	views_free(&views);
	return ok;
}
