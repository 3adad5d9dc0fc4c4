#include "sfm/merge.h"

#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "sfm/colmap/run.h"
#include "sfm/mapper.h"

#define MERGED CALIBRATE_DIR "/merged"
#define LESS CALIBRATE_DIR "/less"
#define JOINED CALIBRATE_DIR "/joined"

/* Name of the image that sees the most points: it can be registered again most surely. */
static const char *best_held(const struct colmap_model *m)
{
	int most = -1, best = 0;
	for (int i = 0; i < m->n_images; i++) {
		int n = 0;
		for (int k = 0; k < m->images[i].n_seen; k++)
			n += m->images[i].seen[k].point >= 0;
		if (n > most)
			best = i;
		most = n > most ? n : most;
	}
	return m->images[best].name;
}

/* Runs merger and mapper; the result stands in JOINED. COLMAP's bundle adjuster cannot be restricted to one thread, and on several its
 * sums differ from run to run. Its mapper can, and it adjusts everything when it registers a picture: so one picture is removed from
 * the merged model for the mapper to register again. */
static bool run_all(const struct colmap_model *best, const char *one, const char *other, const struct views *views,
                    struct stage *stage, const struct calibrate_options *o, struct err *err)
{
	const char *merged = stage_path(stage, MERGED), *less = stage_path(stage, LESS), *list = stage_path(stage, MERGED "/one.txt");
	const char *const merge[] = { "--input_path1", one, "--input_path2", other, "--output_path", merged, 0 };
	const char *const take[] = { "--input_path", merged, "--output_path", less, "--image_names_path", list, 0 };
	char *name = mem_printf("%s\n", best_held(best));
	bool ok = file_mkdirs(merged, err) && file_mkdirs(less, err) && file_write(list, name, strlen(name), err)
	          && colmap_run(stage, "model_merger", merge, 0, "", err) && colmap_run(stage, "image_deleter", take, 0, "", err)
	          && mapper_run(stage, views, &(struct mapper_step){ LESS, JOINED, false, true, true }, o, err);
	file_remove(list, &(struct err){ 0 });
	free(name);
	return ok;
}

/* Checks a merged model: every picture sees enough points, and the one that was removed is registered again. Neither holds where the
 * models were aligned wrongly. */
static bool holds(const struct colmap_model *m, const char *back, int least)
{
	bool is_back = false;
	for (int i = 0; i < m->n_images; i++)
		is_back |= !strcmp(m->images[i].name, back);
	if (!is_back)
		return false;
	for (int i = 0; i < m->n_images; i++) {
		int n = 0;
		for (int k = 0; k < m->images[i].n_seen; k++)
			n += m->images[i].seen[k].point >= 0;
		if (n < least)
			return false;
	}
	return true;
}

/* Merges one other model into best. joined: out, whether it brought pictures and fits. */
static bool join(bool *joined, struct colmap_model *best, const char *one, const char *other, const struct views *views,
                 struct stage *stage, const struct calibrate_options *o, struct err *err)
{
	struct colmap_model m;
	const char *dir = stage_path(stage, JOINED);
	*joined = false;
	if (!run_all(best, one, other, views, stage, o, err) || !colmap_load(&m, dir, err))
		return false;
	bool ok = colmap_check_errors(&m, dir, err);
	if (ok && m.n_images > best->n_images && holds(&m, best_held(best), o->min_matches)) {
		struct colmap_model was = *best;
		*best = m;
		m = was;
		*joined = true;
	}
	colmap_free(&m);
	return ok;
}

bool merge_models(struct colmap_model *best, int *n_models, int at, const struct views *views, struct stage *stage,
                  const struct calibrate_options *o, struct err *err)
{
	const char *one = stage_path(stage, TRIALS "/%d", at);
	bool ok = true;
	for (int i = 0; i < MODEL_TRIALS && ok; i++) {
		const char *other = stage_path(stage, TRIALS "/%d", i);
		bool joined = false;
		if (i == at || !file_exists(stage_path(stage, TRIALS "/%d/cameras.bin", i)))
			continue;
		ok = join(&joined, best, one, other, views, stage, o, err);
		if (joined) {
			// The next one is merged into this result.
			mapper_remove(stage, TRIALS "/joined");
			ok = file_mkdirs(stage_path(stage, TRIALS), err) && colmap_save(best, stage_path(stage, TRIALS "/joined"), COLMAP_BINARY, err);
			one = stage_path(stage, TRIALS "/joined");
			stage_note(stage, "two models share pictures: joined to one of %d", best->n_images);
			--*n_models;
		}
	}
	mapper_remove(stage, MERGED);
	mapper_remove(stage, LESS);
	mapper_remove(stage, JOINED);
	mapper_remove(stage, TRIALS "/joined");
	return ok;
}
