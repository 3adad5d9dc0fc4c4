#include "stages/train/clip.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/csv.h"
#include "base/json.h"
#include "base/mem.h"
#include "base/npy/npy.h"
#include "model/gaze_table.h"

/* lids_model.npy, lids in the modelling camera, exists only where the head moved; else those of the video's frames are the same. */
static const char *const files[] = { "work/skin/gaze.csv",       "work/skin/lids.npy",       "work/skin/lids_model.npy",
	                                 "work/skin/skin_model.npy", "work/skin/confidence.npy", "work/skin/vertices.npy",
	                                 "work/skin/track.json" };
enum { PICTURE_PX = 1000000 };  // no point of a video is that far away
enum { GAZE, LIDS, LIDS_MODEL, SKIN, CONFIDENCE, VERTICES, TRACK };

static bool may_be_missing(int file)
{
	return file == LIDS_MODEL || file == TRACK;
}

void clip_inputs(const char *out[8], int *n, struct stage *stage)
{
	*n = 0;
	for (int i = 0; i < COUNT(files); i++)
		if (!may_be_missing(i) || file_exists(stage_path(stage, "%s", files[i])))
			out[(*n)++] = files[i];
}

static bool read_gaze(struct clip *clip, struct stage *stage, struct err *err)
{
	const char *path = stage_path(stage, "%s", files[GAZE]);
	struct csv_table table;
	bool ok = csv_read(&table, path, err) && gaze_table_check(&table, path, err);
	int n_au = 0, column[SKIN_EYE_INPUTS], time = ok ? csv_need(&table, "time_s", path, err) : -1;
	int trust[2] = { csv_column(&table, "confidence_left"), csv_column(&table, "confidence_right") };
	ok = ok && time >= 0;
	for (int i = 0; i < SKIN_EYE_INPUTS && ok; i++)
		ok = (column[i] = csv_need(&table, gaze_columns[i], path, err)) >= 0;
	char au[32] = "au1";
	for (; ok && csv_column(&table, au) >= 0; n_au++)
		snprintf(au, sizeof au, "au%d", n_au + 2);
	struct train_clip *t = &clip->train;
	t->n = table.n_rows;
	t->n_au = n_au;
	int width = SKIN_EYE_INPUTS + n_au;
	clip->time = mem_new((size_t)t->n + 1, sizeof *clip->time);
	clip->g = mem_new((size_t)t->n * (size_t)width + 1, sizeof *clip->g);
	clip->confidence = mem_new(2 * (size_t)t->n + 1, sizeof *clip->confidence);
	for (long r = 0; r < t->n && ok; r++) {
		clip->time[r] = csv_at(&table, r, time);
		if (isnan(clip->time[r]) || (r && !(clip->time[r] >= clip->time[r - 1])))
			ok = err_set(err, "%s:%d: time_s = %g: must be a number, not below that of the line before", path, table.line[r], clip->time[r]);
		for (int i = 0; i < width; i++) {
			snprintf(au, sizeof au, "au%d", i - SKIN_EYE_INPUTS + 1);
			clip->g[r * width + i] = csv_at(&table, r, i < SKIN_EYE_INPUTS ? column[i] : csv_column(&table, au));
		}
		for (int e = 0; e < 2; e++)
			clip->confidence[2 * r + e] = csv_at(&table, r, trust[e]);
	}
	csv_table_free(&table);
	return ok;
}

static void name_expressions(struct clip *clip, const struct opt_each_list *expressions)
{
	clip->au_names = mem_new((size_t)clip->train.n_au + 1, sizeof *clip->au_names);
	for (int i = 0; i < clip->train.n_au; i++)
		clip->au_names[i] = i < expressions->n ? mem_str(expressions->items[i].name) : mem_printf("au%d", i + 1);
}

/* Eyes of which both were followed. */
static void read_eyes(struct skin_eyes *eyes, const json_t *track)
{
	static const char *const names[2] = { "left_eye", "right_eye" };
	struct err none = { 0 };
	bool ok = true;
	*eyes = skin_eyes_unknown();
	for (int s = 0; s < 2 && ok; s++) {
		const json_t *eye = json_object_get(track, names[s]);
		ok = json_is_object(eye) && json_get_array(eyes->center[s], 3, eye, "center_in_head_mm", "", &none) && json_get(&eyes->radius[s], eye, "radius_mm", "", &none)
		     && json_get(&eyes->limbus[s], eye, "limbus_radius_mm", "", &none) && eyes->limbus[s] > 0 && eyes->limbus[s] < eyes->radius[s];
	}
	if (!ok)
		*eyes = skin_eyes_unknown();
}

static bool read_camera(struct clip *clip, struct stage *stage, struct err *err)
{
	struct skin_camera *c = &clip->camera;
	const char *path = stage_path(stage, "%s", files[TRACK]);
	*c = (struct skin_camera){ .cam_from_head = { { 1 }, { 0, 1 }, { 0, 0, 1 }, { 0, 0, 0, 1 } } };
	clip->eyes = skin_eyes_unknown();
	if (!file_exists(path))
		return true;
	json_t *j = json_read(path, 1 << 24, err);
	const json_t *camera = json_object_get(j, "camera");
	double width = 0, height = 0, reference = 0;
	bool ok = j && json_get(&width, camera, "width", path, err) && json_get(&height, camera, "height", path, err)
	          && json_get(&c->focal_px, camera, "focal_px", path, err)
	          && json_get_array(c->center_px, 2, camera, "center_px", path, err)
	          && json_get_array(c->distortion, 5, camera, "distortion", path, err)
	          && json_get_array(&c->cam_from_head[0][0], 16, camera, "cam_from_head", path, err)
	          && json_get(&reference, j, "reference_frame", path, err);
	c->width = (int)width;
	c->height = (int)height;
	if (ok && !(reference >= 0 && reference < (double)clip->train.n))
		ok = err_set(err, "%s: reference_frame = %g: must be in [0, %ld]", path, reference, clip->train.n - 1);
	if (ok)
		read_eyes(&clip->eyes, j);
	clip->train.reference = ok ? (long)reference : 0;
	json_decref(j);
	return ok;
}

static bool read_vertices(struct clip *clip, struct stage *stage, struct err *err)
{
	const char *path = stage_path(stage, "%s", files[VERTICES]);
	struct npy rows;
	bool ok = npy_read(&rows, path, 1 << 28, err) && npy_expect(&rows, path, 1, (long[]){ -1 }, err);
	clip->train.n_vertices = ok ? (int)rows.shape[0] : 0;
	clip->vertices = mem_new((size_t)clip->train.n_vertices + 1, sizeof *clip->vertices);
	double *x = ok ? npy_doubles(&rows) : 0;
	for (int i = 0; ok && i < clip->train.n_vertices; i++) {
		ok = x[i] >= 0 && x[i] < 1 << 30 ? true : err_set(err, "%s: vertex %d = %g: must be a row of the mesh", path, i, x[i]);
		clip->vertices[i] = ok ? (int)x[i] : 0;
	}
	free(x);
	npy_free(&rows);
	return ok;
}

static bool open_rows(struct npy_rows **out, long *length, struct stage *stage, int file, int ndim, const long *shape,
                      struct err *err)
{
	const char *path = stage_path(stage, "%s", files[file]);
	struct npy head;
	*out = npy_rows_open(&head, path, err);
	if (!*out || !npy_expect(&head, path, ndim, shape, err))
		return false;
	*length = head.shape[ndim == 4 ? 2 : 1];
	return true;
}

static bool open_all(struct clip *clip, struct stage *stage, struct err *err)
{
	const long n = clip->train.n, m = clip->train.n_vertices;
	long points = 0, same;
	int lids = file_exists(stage_path(stage, "%s", files[LIDS_MODEL])) ? LIDS_MODEL : LIDS;
	bool ok = open_rows(&clip->lids, &points, stage, lids, 4, (long[]){ n, SKIN_LIDS, -1, 2 }, err)
	          && (!m || (open_rows(&clip->skin, &same, stage, SKIN, 3, (long[]){ n, m, 2 }, err)
	                     && open_rows(&clip->seen, &same, stage, CONFIDENCE, 2, (long[]){ n, m }, err)));
	if (ok && !(points >= 2 && points <= 200))
		ok = err_set(err, "%s: %ld control points a lid: must be in [2, 200]", stage_path(stage, "%s", files[lids]), points);
	clip->train.n_points = (int)points;
	clip->lids_file = lids;
	return ok;
}

/* Numbers of n rows, from row `first` of that file. */
static bool in_range(const double *x, long n, long each, struct clip *clip, int file, double most, long first, struct err *err)
{
	const struct npy rows = npy_of(NPY_F8, 1, (long[]){ n * each }, x);
	return npy_in_range(&rows, most, true, first * each, stage_path(clip->stage, "%s", files[file]), err);
}

/* The next n rows of one file, which is at the row that clip->at says. */
static bool next_rows(struct clip *clip, struct npy_rows *rows, long first, long n, double *out, long each, int file, double most, struct err *err)
{
	long got;
	return (first == clip->at || npy_rows_seek(rows, first, err)) && npy_rows_next(rows, n, out, &got, err)
	       && in_range(out, got, each, clip, file, most, first, err);
}

static bool clip_read(void *ctx, long first, long n, double *lid, double *skin, double *seen, struct err *err)
{
	struct clip *clip = ctx;
	const long m = clip->train.n_vertices;
	const bool ok = next_rows(clip, clip->lids, first, n, lid, SKIN_LIDS * 2L * clip->train.n_points, clip->lids_file, PICTURE_PX, err)
	                && (!m || (next_rows(clip, clip->skin, first, n, skin, 2 * m, SKIN, PICTURE_PX, err)
	                           && next_rows(clip, clip->seen, first, n, seen, m, CONFIDENCE, 1, err)));
	clip->at = first + n;
	return ok;
}

static void clip_progress(void *ctx, long done, long total)
{
	struct clip *clip = ctx;
	stage_progress(clip->stage, (int)done, (int)total, "frames");
}

bool clip_load(struct clip *clip, struct stage *stage, const struct opt_each_list *expressions, struct err *err)
{
	*clip = (struct clip){ .stage = stage, .place = mem_str(files[GAZE]) };
	if (!read_gaze(clip, stage, err))
		return false;
	if (clip->train.n < 2)
		return err_set(err, "%s: %ld frames: film longer", files[GAZE], clip->train.n);
	name_expressions(clip, expressions);
	struct train_clip *t = &clip->train;
	t->time = clip->time;
	t->g = clip->g;
	t->confidence = clip->confidence;
	t->read = clip_read;
	t->ctx = clip;
	t->progress = clip_progress;
	t->place = clip->place;
	return read_camera(clip, stage, err) && read_vertices(clip, stage, err) && open_all(clip, stage, err);
}

void clip_free(struct clip *clip)
{
	for (int i = 0; clip->au_names && i < clip->train.n_au; i++)
		free(clip->au_names[i]);
	free(clip->au_names);
	free(clip->vertices);
	free(clip->time);
	free(clip->g);
	free(clip->confidence);
	free(clip->place);
	npy_rows_close(clip->lids);
	npy_rows_close(clip->skin);
	npy_rows_close(clip->seen);
	*clip = (struct clip){ 0 };
}
