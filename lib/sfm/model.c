#include "sfm/model.h"

#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "sfm/advice.h"
#include "sfm/colmap/db.h"
#include "sfm/mapper.h"
#include "sfm/merge.h"

static void remove_trials(struct stage *stage)
{
	for (int i = 0; i < MODEL_TRIALS; i++)
		mapper_remove(stage, stage_path(stage, TRIALS "/%d", i) + strlen(stage->capture) + 1);
	mapper_remove(stage, TRIALS);
}

/* Saves the chosen model in MODEL_DIR and seals it. */
static bool keep(const struct colmap_model *model, struct stage *stage, struct err *err)
{
	const char *dir = stage_path(stage, MODEL_DIR);
	mapper_remove(stage, MODEL_DIR);
	return colmap_save(model, dir, COLMAP_BINARY, err) && colmap_seal(dir, err);
}

/* Loads the model with the most images, then the most points. n: out, how many models there are; at: out, its number, -1 for one that
 * was gone on with. */
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

/* Loads the kept model where it can be gone on with: the old pictures are unchanged and the new ones few. Returns false, no error set,
 * where there is none. */
static bool recall(struct colmap_model *kept, const struct views *views, bool grows, struct stage *stage,
                   const struct calibrate_options *o)
{
	struct err why = { 0 };
	const char *dir = stage_path(stage, MODEL_DIR);
	int n_new = 0;
	*kept = (struct colmap_model){ 0 };
	for (int i = 0; i < views->n_used; i++)
		n_new += views->v[i].is_new;
	// The seal is written last: a model without one is incomplete.
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

/* True when a new picture has a camera that no image of the model has: its parameters are but a guess, and have to be refined. */
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

static bool map(struct colmap_model *model, int *n_models, const struct views *views, const struct mapper_step *step, struct stage *stage,
                const struct calibrate_options *o, struct err *err)
{
	remove_trials(stage);
	struct err why = { 0 };
	bool ok = mapper_run(stage, views, step, o, &why);
	// That it finds no pair to begin with is a result, not a failure: the photographs are to blame.
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

bool model_make(struct colmap_model *model, bool *unfit, const struct views *views, bool grows, struct stage *stage,
                const struct calibrate_options *o, struct err *err)
{
	int n_models = 1, n_new = 0;
	*unfit = false;
	for (int i = 0; i < views->n_used; i++)
		n_new += views->v[i].is_new;
	bool kept = recall(model, views, grows, stage, o);
	const struct mapper_step step = { kept ? MODEL_DIR : 0, TRIALS, kept, !kept || new_lens(model, views), false };
	if (kept && !n_new)
		return true;
	colmap_free(model);
	*model = (struct colmap_model){ 0 };
	struct err none = { 0 };
	if (!kept)  // the cameras move: points measured with the old ones are worth nothing
		file_remove(stage_path(stage, CALIBRATE_DIR "/cloud.grid"), &none);
	bool flat = false;
	if (!advice_is_flat(&flat, stage, err))
		return false;
	if (!flat && !map(model, &n_models, views, &step, stage, o, err))
		return false;
	*unfit = !model->n_images;
	if (*unfit)
		return advice_refuse(views, stage, err);
	advice_warn(model, views, stage);
	stage_note(stage, "%d of %d pictures registered, %d points, %.2f px%s", model->n_images, views->n_used, model->n_points,
	           colmap_residual(model, -1), n_models > 1 ? "; the rest does not connect" : "");
	return keep(model, stage, err) && db_done(stage_path(stage, CALIBRATE_DIR "/database.db"), err);
}
