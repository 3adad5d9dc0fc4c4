/* Cameras and points from checked matches: COLMAP's mapper, begun anew or gone on with; the best of its models. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/mem.h"
#include "sfm/colmap/db.h"
#include "sfm/merge.h"

static const char *const files[] = { "cameras.bin", "images.bin", "points3D.bin", "project.ini", "seal" };

void model_remove(struct stage *stage, const char *dir)
{
	struct err none = { 0 };
	for (int i = 0; i < COUNT(files); i++)
		file_remove(stage_path(stage, "%s/%s", dir, files[i]), &none);
	rmdir(stage_path(stage, "%s", dir));
}

static void remove_trials(struct stage *stage)
{
	for (int i = 0; i < MODEL_TRIALS; i++)
		model_remove(stage, stage_path(stage, TRIALS "/%d", i) + strlen(stage->capture) + 1);
	model_remove(stage, TRIALS);
}

/* Puts the chosen model where it is kept, under seal. */
static bool keep(const struct colmap_model *model, struct stage *stage, struct err *err)
{
	const char *dir = stage_path(stage, MODEL_DIR);
	model_remove(stage, MODEL_DIR);
	return colmap_save(model, dir, COLMAP_BINARY, err) && colmap_seal(dir, err);
}

bool model_map(struct stage *stage, const struct views *views, const struct model_step *step, const struct calibrate_options *o,
               struct err *err)
{
	char *filter = mem_printf("%g", o->filter_px), *angle = mem_printf("%g", o->tri_deg), *rounds = mem_printf("%d", o->ba_rounds);
	char *least = mem_printf("%d", views->n_used < 10 ? 2 : 5), *matches = mem_printf("%d", o->min_matches);
	const char *refine = step->refine ? "1" : "0", *to = stage_path(stage, "%s", step->to);
	// Its sums depend on the number of threads; one is hardly slower, for most of its work is not shared out anyway.
	const char *args[48] = { "--database_path", stage_path(stage, CALIBRATE_DIR "/database.db"),
		"--image_path", stage_path(stage, CALIBRATE_DIR "/pictures"), "--output_path", to, "--Mapper.num_threads", "1",
		"--Mapper.min_num_matches", matches, "--Mapper.min_model_size", least, "--Mapper.max_num_models", "5",
		"--Mapper.filter_max_reproj_error", filter, "--Mapper.filter_min_tri_angle", angle,
		"--Mapper.ba_global_max_refinements", rounds, "--Mapper.ba_refine_focal_length", refine,
		"--Mapper.ba_refine_extra_params", refine, "--Mapper.fix_existing_images", step->fixed ? "1" : "0" };
	int n = 0;
	while (args[n])
		n++;
	if (step->from) {
		args[n++] = "--input_path";
		args[n++] = stage_path(stage, "%s", step->from);
	}
	if (step->adjust_each) {
		args[n++] = "--Mapper.ba_global_images_freq";
		args[n++] = "1";
	}
	bool ok = file_mkdirs(to, err) && colmap_run(stage, "mapper", args, views->n_used, "cameras", err);
	free(filter);
	free(angle);
	free(rounds);
	free(least);
	free(matches);
	return ok;
}

/* The model with the most pictures, then the most points. *n: how many models there are; *at: its number, -1 of one gone on
 * with. */
static bool best_trial(struct colmap_model *best, int *n, int *at, struct stage *stage, struct err *err)
{
	*best = (struct colmap_model){ 0 };
	*n = 0;
	for (int i = -1; i < MODEL_TRIALS; i++) {
		const char *dir = i < 0 ? stage_path(stage, TRIALS) : stage_path(stage, TRIALS "/%d", i);
		char *file = mem_printf("%s/cameras.bin", dir);
		bool there = file_exists(file);
		struct colmap_model m;
		free(file);
		if (!there)
			continue;
		if (!colmap_load(&m, dir, err) || !colmap_check_errors(&m, dir, err))
			return false;
		++*n;
		if (m.n_images > best->n_images || (m.n_images == best->n_images && m.n_points > best->n_points)) {
			struct colmap_model was = *best;
			*best = m;
			m = was;
			*at = i;
		}
		colmap_free(&m);
	}
	return true;
}

/* The model that was kept, when it still says what these pictures say. False without an error: there is none. */
static bool recall(struct colmap_model *kept, const struct views *views, bool grows, struct stage *stage,
                   const struct calibrate_options *o)
{
	struct err why = { 0 };
	const char *dir = stage_path(stage, MODEL_DIR);
	int n_new = 0;
	*kept = (struct colmap_model){ 0 };
	for (int i = 0; i < views->n_used; i++)
		n_new += views->v[i].is_new;
	// The seal is written last: a model without one is half a model.
	char *file = mem_printf("%s/seal", dir);
	bool there = file_exists(file);
	free(file);
	if (!grows || !there || n_new > o->regrow * views->n_used)
		return false;
	if (colmap_load(kept, dir, &why))
		return true;
	stage_warn(stage, "%s: begun anew", why.msg);
	return false;
}

/* A picture has come whose lens none of the model's pictures has: all that is known of it is a guess. */
static bool new_lens(const struct colmap_model *kept, const struct views *views)
{
	for (int i = 0; i < views->n_used; i++) {
		bool known = !views->v[i].is_new;
		for (int k = 0; k < kept->n_images && !known; k++)
			known = kept->cameras[kept->images[k].camera].id == views->cameras[views->v[i].camera].id;
		if (!known)
			return true;
	}
	return false;
}

static bool map(struct colmap_model *model, int *n_models, const struct views *views, const struct model_step *step, struct stage *stage,
                const struct calibrate_options *o, struct err *err)
{
	remove_trials(stage);
	struct err why = { 0 };
	bool ok = model_map(stage, views, step, o, &why);
	// That it found no pair to begin with is a result, and for the photographs to answer for.
	if (!ok && !strstr(why.msg, "failed to create sparse model") && !strstr(why.msg, "No good initial image pair"))
		return err_set(err, "%s", why.msg);
	*n_models = 0;
	*model = (struct colmap_model){ 0 };
	int at = -1;
	ok = !ok || (best_trial(model, n_models, &at, stage, err)
	             && (at < 0 || *n_models < 2 || merge_models(model, n_models, at, views, stage, o, err)));
	remove_trials(stage);
	return ok;
}

bool model_make(struct colmap_model *model, const struct views *views, bool grows, struct stage *stage,
                const struct calibrate_options *o, struct err *err)
{
	int n_models = 1, n_new = 0;
	for (int i = 0; i < views->n_used; i++)
		n_new += views->v[i].is_new;
	bool kept = recall(model, views, grows, stage, o);
	const struct model_step step = { kept ? MODEL_DIR : 0, TRIALS, kept, !kept || new_lens(model, views), false };
	if (kept && !n_new)
		return true;
	colmap_free(model);
	*model = (struct colmap_model){ 0 };
	struct err none = { 0 };
	if (!kept)  // the cameras move: points measured with the old ones are worth nothing
		file_remove(stage_path(stage, CALIBRATE_DIR "/cloud.grid"), &none);
	bool flat = false;
	if (!model_is_flat(&flat, stage, err))
		return false;
	if (!flat && !map(model, &n_models, views, &step, stage, o, err))
		return false;
	if (!model->n_images)
		return model_advice(views, stage, err);
	model_warn(model, views, stage);
	stage_note(stage, "%d of %d pictures registered, %d points, %.2f px%s", model->n_images, views->n_used, model->n_points,
	           colmap_residual(model, -1), n_models > 1 ? "; the rest does not connect" : "");
	return keep(model, stage, err) && db_done(stage_path(stage, CALIBRATE_DIR "/database.db"), err);
}
