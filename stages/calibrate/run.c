#include "stages/calibrate/run.h"

#include <stdlib.h>

#include "stages/calibrate/figure.h"
#include "stages/calibrate/state.h"
#include "stages/calibrate/subject.h"

#define RIG "work/rig.json"

/* The photographs the results are made from. */
static const char **inputs_of(const struct views *views)
{
	const char **in = mem_new((size_t)views->n, sizeof *in);
	for (int i = 0; i < views->n; i++)
		in[i] = views->v[i].file;
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
}

static bool from_views(struct stage *stage, struct views *views, const struct calibrate_options *o, struct err *err)
{
	bool grows;
	struct colmap_model model = { 0 };
	struct head head = { .model = &model };
	struct camera_rig rig = { 0 };
	const char **in = inputs_of(views);
	const char *const rig_alone[] = { RIG };
	bool ok = state_check(stage, o, err) && features_make(&grows, views, stage, o, err) && pairs_match(views, stage, o, err)
	          && model_make(&model, views, grows, stage, o, err) && state_save(stage, o, err)
	          && head_place(&head, views, stage, o, err)
	          && rig_out(&rig, &head, views, stage_path(stage, RIG), stage_made_by(stage, views->n, in), err)
	          && stage_made(stage, RIG, views->n, in, err);
	if (ok && subject_given(stage))
		stage_skipped(stage, "subject mesh: the folder has one");
	else if (ok)
		// Made from the rig, which names all photographs: a mesh's head has to stay short.
		ok = subject_make(&head, views, stage, o, stage_made_by(stage, 1, rig_alone), err)
		     && (!file_exists(stage_path(stage, SUBJECT)) || stage_made(stage, SUBJECT, views->n, in, err));
	ok = ok && figure_draw(&head, &rig, stage, err) && stage_made(stage, FIGURE, views->n, in, err);
	if (ok)
		report(stage, views, &rig, &head);
	free(in);
	camera_rig_free(&rig);
	colmap_free(&model);
	return ok;
}

bool calibrate_run(struct stage *stage, const struct calibrate_options *o, struct err *err)
{
	struct views views;
	bool ok = views_gather(&views, stage, o, err);
	if (ok && views.n_used < 2)
		ok = err_set(err, "%s/views: %d usable photographs, at least 2 are needed, better 20 from all round", stage->capture,
		             views.n_used);
	if (ok)
		ok = from_views(stage, &views, o, err);
	views_free(&views);
	return ok;
}
