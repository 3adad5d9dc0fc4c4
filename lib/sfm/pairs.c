#include "sfm/pairs.h"

#include <cblas.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "sfm/colmap/db.h"
#include "sfm/colmap/db_matches.h"
#include "sfm/colmap/run.h"

/* The verification draws at random (RANSAC). It is run in this many parts whatever the number of threads, so that its result is always
 * the same. */
enum { PARTS = 4 };

static bool load_features(struct sfm_features *f, const struct views *views, struct db *db, struct err *err)
{
	bool ok = true;
	for (int i = 0; i < views->n_used && ok; i++)
		ok = db_features(&f[i], db, views->v[i].id, err);
	return ok;
}

/* Selects the pairs to match: those with a new picture; the others have been matched before. */
static struct sfm_pair *choose(int *n, const struct sfm_features *f, const struct views *views, struct stage *stage,
                               const struct calibrate_options *o)
{
	int first_new = 0;
	while (first_new < views->n_used && !views->v[first_new].is_new)
		first_new++;
	struct sfm_overlap_conf conf = o->overlap;
	struct sfm_pair *pairs = sfm_overlap(n, views->n_used, f, first_new, &conf);
	if (!first_new && o->sequence_neighbours && sfm_is_sequence(views->n_used, pairs, *n)) {
		free(pairs);
		conf.neighbours = o->sequence_neighbours;
		pairs = sfm_overlap(n, views->n_used, f, 0, &conf);
		stage_note(stage, "the pictures come in the order they were taken");
	}
	stage_note(stage, "%d of %d pairs of pictures overlap", *n, views->n_used * (views->n_used - 1) / 2);
	return pairs;
}

static struct db_pair *match_all(int *n, const struct sfm_features *f, const struct sfm_pair *pairs, int n_pairs,
                                 const struct views *views, struct stage *stage, const struct calibrate_options *o)
{
	struct db_pair *out = mem_new((size_t)n_pairs, sizeof *out);
	int done = 0, kept = 0;
#pragma omp parallel for schedule(dynamic)
	for (int i = 0; i < n_pairs; i++) {
		out[i].a = views->v[pairs[i].a].id;
		out[i].b = views->v[pairs[i].b].id;
		sfm_match(&out[i].matches, &f[pairs[i].a], &f[pairs[i].b], &o->overlap.match);
#pragma omp critical
		stage_progress(stage, ++done, n_pairs, "matches");
	}
	for (int i = 0; i < n_pairs; i++)
		if (out[i].matches.n >= o->min_matches)
			out[kept++] = out[i];
		else
			free(out[i].matches.index);
	*n = kept;
	return out;
}

static bool list_pairs(const char *path, int n, const struct db_pair *pairs, const struct views *views, struct err *err)
{
	char *text = 0;
	size_t size = 0;
	FILE *f = open_memstream(&text, &size);
	for (int i = 0; i < n; i++) {
		const char *a = "", *b = "";
		for (int k = 0; k < views->n_used; k++) {
			a = views->v[k].id == pairs[i].a ? views->v[k].picture : a;
			b = views->v[k].id == pairs[i].b ? views->v[k].picture : b;
		}
		fprintf(f, "%s %s\n", a, b);
	}
	fclose(f);
	bool ok = file_write(path, text, size, err);
	free(text);
	return ok;
}

struct part {
	const char *database, *list;
	const char *args[16];
	char least[16];
	struct db_pair *pairs;
	int n;
};

static bool part_make(struct part *part, int k, struct db *db, const struct views *views, struct stage *stage,
                      const struct calibrate_options *o, struct err *err)
{
	struct err none = { 0 };
	part->database = stage_path(stage, CALIBRATE_DIR "/part-%d.db", k);
	part->list = stage_path(stage, CALIBRATE_DIR "/part-%d.txt", k);
	file_remove(part->database, &none);
	const char *const create[] = { "--database_path", part->database, 0 };
	snprintf(part->least, sizeof part->least, "%d", o->min_matches);
	const char *const args[] = { "--database_path", part->database, "--match_list_path", part->list, "--match_type", "pairs",
		"--SiftMatching.use_gpu", "0", "--SiftMatching.num_threads", "1", "--SiftMatching.min_num_inliers",
		part->least, 0 };
	memcpy(part->args, args, sizeof args);
	return colmap_run(stage, "database_creator", create, 0, "", err) && db_part(db, part->database, part->n, part->pairs, err)
	       && list_pairs(part->list, part->n, part->pairs, views, err);
}

static bool check_all(struct db *db, int n, struct db_pair *pairs, const struct views *views, struct stage *stage,
                      const struct calibrate_options *o, struct err *err)
{
	struct part parts[PARTS] = { 0 };
	const char *const *args[PARTS];
	int used = n < PARTS ? 1 : PARTS;
	bool ok = true;
	for (int k = 0; k < used; k++) {
		parts[k].pairs = mem_array((size_t)n, sizeof *parts[k].pairs);
		for (int i = k; i < n; i += used)
			parts[k].pairs[parts[k].n++] = pairs[i];
		ok = ok && part_make(&parts[k], k, db, views, stage, o, err);
		args[k] = parts[k].args;
	}
	ok = ok && colmap_run_parts(stage, "matches_importer", used, args, "check", err);
	for (int k = 0; k < used; k++) {
		struct err none = { 0 };
		ok = ok && db_join(db, parts[k].database, err);
		free(parts[k].pairs);
		if (parts[k].database) {
			file_remove(parts[k].database, &none);
			file_remove(parts[k].list, &none);
		}
	}
	return ok;
}

static void pairs_free(struct db_pair *pairs, int n)
{
	for (int i = 0; i < n; i++)
		free(pairs[i].matches.index);
	free(pairs);
}

bool pairs_match(const struct views *views, struct stage *stage, const struct calibrate_options *o, struct err *err)
{
	struct db *db = 0;
	bool any_new = false;
	for (int i = 0; i < views->n_used; i++)
		any_new |= views->v[i].is_new;
	if (!any_new)
		return true;
	struct sfm_features *f = mem_new((size_t)views->n_used, sizeof *f);
	struct sfm_pair *pairs = 0;
	struct db_pair *matched = 0;
	int n_pairs = 0, n = 0, checked = 0;
	long matches = 0;
	bool ok = db_open(&db, stage_path(stage, CALIBRATE_DIR "/database.db"), err) && load_features(f, views, db, err);
	if (ok) {
		openblas_set_num_threads(1);  // every pair has a thread of its own
		pairs = choose(&n_pairs, f, views, stage, o);
		matched = match_all(&n, f, pairs, n_pairs, views, stage, o);
		ok = !n || check_all(db, n, matched, views, stage, o, err);
	}
	ok = ok && db_checked(&checked, &matches, db, 0, err);
	if (ok)
		stage_note(stage, "%d pairs agree with one motion of the camera, by %ld matches", checked, matches);
	for (int i = 0; i < views->n_used; i++)
		sfm_features_free(&f[i]);
	free(f);
	free(pairs);
	pairs_free(matched, n);
	db_close(db);
	return ok;
}
