#include "sfm/features.h"

#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "sfm/colmap/db.h"
#include "sfm/colmap/run.h"

static bool open_database(struct db **db, struct stage *stage, struct err *err)
{
	const char *path = stage_path(stage, CALIBRATE_DIR "/database.db");
	const char *const args[] = { "--database_path", path, 0 };
	if (file_exists(path) && !db_is_sound(path)) {
		stage_warn(stage, "%s: damaged: made anew", path);
		if (!db_remove(path, err))
			return false;
	}
	return (file_exists(path) || colmap_run(stage, "database_creator", args, 0, "", err)) && db_open(db, path, err);
}

static bool sync(bool *same, struct views *views, struct db *db, struct err *err)
{
	struct db_image *images = mem_new((size_t)views->n_used, sizeof *images);
	for (int i = 0; i < views->n_used; i++)
		images[i] = (struct db_image){ views->v[i].picture, views->v[i].camera, 0, false };
	bool ok = db_sync(same, db, views->n_cameras, views->cameras, views->has_focal, views->n_used, images, err);
	for (int i = 0; i < views->n_used; i++) {
		views->v[i].id = images[i].id;
		views->v[i].is_new = images[i].is_new;
	}
	free(images);
	return ok;
}

static int by_id(const void *a, const void *b)
{
	const struct view *p = a, *q = b;
	return (p->id > q->id) - (p->id < q->id);
}

static bool extract(struct stage *stage, const struct calibrate_options *o, int n_new, int threads, struct err *err)
{
	char *px = mem_printf("%d", o->picture_px), *features = mem_printf("%d", o->features), *t = mem_printf("%d", threads);
	// The pictures have the size that is searched: first octave 0 is their own resolution.
	const char *const args[] = { "--database_path", stage_path(stage, CALIBRATE_DIR "/database.db"),
		"--image_path", stage_path(stage, CALIBRATE_DIR "/pictures"),
		"--image_list_path", stage_path(stage, CALIBRATE_DIR "/new.txt"),
		"--SiftExtraction.use_gpu", "0", "--SiftExtraction.max_image_size", px,
		"--SiftExtraction.first_octave", o->first_octave < 0 ? "-1" : "0",
		"--SiftExtraction.max_num_features", features, "--SiftExtraction.num_threads", t, 0 };
	bool ok = colmap_run(stage, "feature_extractor", args, n_new, "features", err) && db_featured(args[1], err);
	free(px);
	free(features);
	free(t);
	return ok;
}

static bool list_new(int *n, const struct views *views, const char *path, struct err *err)
{
	char *text = 0;
	size_t size = 0;
	FILE *f = open_memstream(&text, &size);
	*n = 0;
	for (int i = 0; i < views->n_used; i++)
		if (views->v[i].is_new) {
			fprintf(f, "%s\n", views->v[i].picture);
			++*n;
		}
	fclose(f);
	bool ok = file_write(path, text, size, err);
	free(text);
	return ok;
}

bool features_make(bool *grows, struct views *views, struct stage *stage, const struct calibrate_options *o,
                   struct err *err)
{
	struct db *db = 0;
	int n_new;
	bool same = false;
	if (!open_database(&db, stage, err))
		return false;
	bool ok = sync(&same, views, db, err);
	db_close(db);
	// By id: new pictures have the highest ids and come last.
	qsort(views->v, (size_t)views->n_used, sizeof *views->v, by_id);
	const char *list = stage_path(stage, CALIBRATE_DIR "/new.txt");
	ok = ok && list_new(&n_new, views, list, err) && (!n_new || extract(stage, o, n_new, stage->threads, err))
	     && file_remove(list, err);
	*grows = same && ok && n_new < views->n_used;
	return ok;
}
