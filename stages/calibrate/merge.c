#include "stages/calibrate/merge.h"

#include <stdlib.h>

#include "base/mem.h"

#define MERGED CALIBRATE_DIR "/merged"
#define ADJUSTED CALIBRATE_DIR "/adjusted"
#define JOINED CALIBRATE_DIR "/joined"

/* Merger, adjustment, filter: the result in JOINED. */
static bool run_all(const char *one, const char *other, struct stage *stage, const struct calibrate_options *o, struct err *err)
{
	const char *merged = stage_path(stage, MERGED), *adjusted = stage_path(stage, ADJUSTED), *joined = stage_path(stage, JOINED);
	char *filter = mem_printf("%g", o->filter_px), *angle = mem_printf("%g", o->tri_deg);
	const char *const merge[] = { "--input_path1", one, "--input_path2", other, "--output_path", merged, 0 };
	const char *const adjust[] = { "--input_path", merged, "--output_path", adjusted, 0 };
	const char *const drop[] = { "--input_path", adjusted, "--output_path", joined, "--max_reproj_error", filter, "--min_tri_angle",
		                         angle, 0 };
	bool ok = file_mkdirs(merged, err) && file_mkdirs(adjusted, err) && file_mkdirs(joined, err)
	          && colmap_run(stage, "model_merger", merge, 0, "", err) && colmap_run(stage, "bundle_adjuster", adjust, 0, "", err)
	          && colmap_run(stage, "point_filtering", drop, 0, "", err);
	free(filter);
	free(angle);
	return ok;
}

/* Every picture still sees enough points: where the models were laid onto each other wrongly, those are gone. */
static bool holds(const struct colmap_model *m, int least)
{
	for (int i = 0; i < m->n_images; i++) {
		int n = 0;
		for (int k = 0; k < m->images[i].n_seen; k++)
			n += m->images[i].seen[k].point >= 0;
		if (n < least)
			return false;
	}
	return true;
}

/* *joined: the other model brought pictures, and fits. */
static bool join(bool *joined, struct colmap_model *best, const char *one, const char *other, struct stage *stage,
                 const struct calibrate_options *o, struct err *err)
{
	struct colmap_model m;
	const char *dir = stage_path(stage, JOINED);
	*joined = false;
	if (!run_all(one, other, stage, o, err) || !colmap_load(&m, dir, err))
		return false;
	bool ok = colmap_check_errors(&m, dir, err);
	if (ok && m.n_images > best->n_images && holds(&m, o->min_matches)) {
		struct colmap_model was = *best;
		*best = m;
		m = was;
		*joined = true;
	}
	colmap_free(&m);
	return ok;
}

bool merge_models(struct colmap_model *best, int *n_models, int at, struct stage *stage, const struct calibrate_options *o,
                  struct err *err)
{
	const char *one = stage_path(stage, TRIALS "/%d", at);
	bool ok = true;
	for (int i = 0; i < MODEL_TRIALS && ok; i++) {
		const char *other = stage_path(stage, TRIALS "/%d", i);
		bool joined = false;
		if (i == at || !file_exists(stage_path(stage, TRIALS "/%d/cameras.bin", i)))
			continue;
		ok = join(&joined, best, one, other, stage, o, err);
		if (joined) {
			// What is joined next is joined to this.
			model_remove(stage, TRIALS "/joined");
			ok = file_mkdirs(stage_path(stage, TRIALS), err) && colmap_save(best, stage_path(stage, TRIALS "/joined"), COLMAP_BINARY, err);
			one = stage_path(stage, TRIALS "/joined");
			stage_note(stage, "two models share pictures: joined to one of %d", best->n_images);
			--*n_models;
		}
	}
	model_remove(stage, MERGED);
	model_remove(stage, ADJUSTED);
	model_remove(stage, JOINED);
	model_remove(stage, TRIALS "/joined");
	return ok;
}
