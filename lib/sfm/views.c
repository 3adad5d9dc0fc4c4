#include "sfm/views.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/asked.h"
#include "base/mem.h"
#include "base/record.h"
#include "image/photo/photo.h"
#include "optics/sensor.h"
#include "sfm/frames.h"

static uint8_t *narrow(const struct photo *photo, int channels)
{
	long n = (long)photo->width * photo->height;
	uint8_t *px = mem_array((size_t)n * (size_t)channels, 1);
	for (long i = 0; i < n; i++)
		for (int c = 0; c < channels; c++)
			px[channels * i + c] = (uint8_t)(photo->rgb[3 * i + c] >> 8);
	return px;
}

static bool make_picture(struct view *view, const char *path, const struct photo *photo, int picture_px, struct err *err)
{
	int channels = photo->grey ? 1 : 3;
	view->width = photo->width;
	view->height = photo->height;
	view->focal_px = photo->exif.focal_px;
	if (!isfinite(view->focal_px))
		view->focal_px = sensor_focal_px(photo->exif.model, photo->exif.focal_mm, photo->width > photo->height ? photo->width : photo->height);
	strcpy(view->maker, photo->exif.model);
	uint8_t *px = narrow(photo, channels);
	bool ok = view_picture(view, path, px, channels, picture_px, err);
	free(px);
	return ok;
}

/* Decodes one photograph and writes its picture. A photograph that cannot be read is left out with the reason; returns false only where
 * the picture cannot be written. */
static bool prepare(struct view *view, const char *path, const char *picture, const struct calibrate_options *o,
                    struct err *err)
{
	struct photo photo = { 0 };
	struct err why = { 0 };
	if (!photo_load(&photo, path, o->limit_mpx, &why)) {
		snprintf(view->reason, sizeof view->reason, "%.250s", err_less(&why, path));
		return true;
	}
	bool ok = make_picture(view, picture, &photo, o->picture_px, err);
	photo_free(&photo);
	return ok;
}

static void add_folder(struct views *views, struct stage *stage, const char *dir, struct err *err)
{
	struct file_list list;
	if (!stage_list(stage, &list, dir, err))
		return;
	views->v = mem_grow(views->v, (size_t)(views->n + list.n), sizeof *views->v);
	for (int i = 0; i < list.n; i++)
		views->v[views->n++] = (struct view){ .file = mem_printf("%s/%s", dir, list.names[i]), .focal_px = NAN, .frame = -1 };
	file_list_free(&list);
}

/* Names each picture by the hash of its photograph and the size to which it is reduced. */
static void name_pictures(struct views *views, struct stage *stage, const struct calibrate_options *o)
{
	for (int i = 0; i < views->n; i++) {
		struct view *v = &views->v[i];
		const char *hash = record_hash(stage->record, v->file);
		if (hash)
			snprintf(v->picture, sizeof v->picture, "%.16s-%d.jpg", hash, o->picture_px);
		else
			snprintf(v->reason, sizeof v->reason, "cannot be read");
		for (int k = 0; k < i && !*v->reason; k++)
			if (!strcmp(views->v[k].picture, v->picture))
				snprintf(v->reason, sizeof v->reason, "the same file as %.200s", views->v[k].file);
	}
}

static bool prepare_all(struct views *views, struct stage *stage, const struct calibrate_options *o, struct err *err)
{
	int done = 0;
	char **paths = mem_new((size_t)views->n, sizeof *paths), **pictures = mem_new((size_t)views->n, sizeof *pictures);
	for (int i = 0; i < views->n; i++) {
		paths[i] = (char *)stage_path(stage, "%s", views->v[i].file);
		pictures[i] = (char *)stage_path(stage, CALIBRATE_DIR "/pictures/%s", views->v[i].picture);
	}
	bool ok = true;
#pragma omp parallel for schedule(dynamic)
	for (int i = 0; i < views->n; i++) {
		struct view *v = &views->v[i];
		struct err mine = { 0 };
		bool stands = v->picture_width && file_exists(pictures[i]);
		if (!*v->reason && !stands && !prepare(v, paths[i], pictures[i], o, &mine))
#pragma omp critical
			ok = err_set(err, "%s", mine.msg);
#pragma omp critical
		stage_progress(stage, ++done, views->n, "photographs");
	}
	free(paths);
	free(pictures);
	return ok;
}

/* Leaves out pictures that hardly differ from the one kept before them; of more than max_views keeps that many, evenly spaced. */
static void thin(struct views *views, struct stage *stage, const struct calibrate_options *o)
{
	int last = -1, same = 0, kept = 0, over = 0;
	for (int i = 0; i < views->n; i++) {
		struct view *v = &views->v[i];
		if (*v->reason)
			continue;
		if (last >= 0 && view_difference(v->thumb, views->v[last].thumb) < o->same_level) {
			v->spare = true;
			snprintf(v->reason, sizeof v->reason, "nearly the same as %.200s", views->v[last].file);
			same++;
		} else {
			last = i;
			kept++;
		}
	}
	for (int i = 0, k = 0; i < views->n && kept > o->max_views; i++) {
		struct view *v = &views->v[i];
		if (*v->reason)
			continue;
		k++;
		// The k-th of `kept` stays where k max_views / kept passes a whole number.
		if ((long)k * o->max_views / kept != (long)(k - 1) * o->max_views / kept)
			continue;
		v->spare = true;
		snprintf(v->reason, sizeof v->reason, "%d views are enough", o->max_views);
		over++;
	}
	if (same || over)
		stage_warn(stage, "views: %d of %d left out: %d hardly differ from the one before, %d for there are more than %d", same + over,
		           views->n, same, over, o->max_views);
}

static void say_left_out(const struct views *views, struct stage *stage)
{
	for (int i = 0; i < views->n; i++)
		if (*views->v[i].reason && !views->v[i].spare)
			stage_skipped(stage, "%s: %s", views->v[i].file, views->v[i].reason);
}

/* Puts those in use first; otherwise keeps the order. */
static void sort_used(struct views *views)
{
	struct view *out = mem_new((size_t)views->n, sizeof *out);
	int n = 0;
	for (int left_out = 0; left_out < 2; left_out++) {
		for (int i = 0; i < views->n; i++)
			if (!!*views->v[i].reason == left_out)
				out[n++] = views->v[i];
		views->n_used = left_out ? views->n_used : n;
	}
	free(views->v);
	views->v = out;
}

/* How many frames to take: beside photographs a few suffice, for the video's lens; without them all cameras come from frames. */
static int frames_wanted(const struct views *views, const struct calibrate_options *o)
{
	int n = 0;
	for (int i = 0; i < views->n; i++)
		n += !*views->v[i].reason && !strncmp(views->v[i].file, "views/", 6);
	return n >= 2 ? o->video_frames_beside : o->video_frames;
}

/* Cameras that were found without a photograph are kept and built upon: one that a failing disk did not give is no photograph that
 * cannot be used. */
static bool disk_gave_all(struct err *err)
{
	const char *file = asked_trouble();
	return !file || err_set(err, "%s: the disk does not give it: cameras are not sought without it", file);
}

bool views_gather(struct views *views, struct stage *stage, const struct calibrate_options *o, struct err *err)
{
	*views = (struct views){ 0 };
	if (!keys_check_names(&stage->conf, stage->capture, err))
		return false;
	add_folder(views, stage, "views", err);
	add_folder(views, stage, "photos", err);
	if (err_is(err) || !file_mkdirs(stage_path(stage, CALIBRATE_DIR "/pictures"), err))
		return false;
	name_pictures(views, stage, o);
	struct pictures known;
	pictures_load(&known, stage_path(stage, CALIBRATE_DIR "/pictures.json"));
	pictures_recall(views, &known);
	bool ok = prepare_all(views, stage, o, err) && disk_gave_all(err) && frames_add(views, frames_wanted(views, o), &known, stage, o, err);
	if (ok) {
		thin(views, stage, o);
		say_left_out(views, stage);
		sort_used(views);
		pictures_cameras(views, &known, o);
		ok = pictures_save(views, &known, stage_path(stage, CALIBRATE_DIR "/pictures.json"), err);
	}
	pictures_free(&known);
	return ok;
}

bool views_are_video(const struct views *views)
{
	for (int i = 0; i < views->n_used; i++)
		if (!strncmp(views->v[i].file, "views/", 6))
			return false;
	return true;
}

void views_free(struct views *views)
{
	for (int i = 0; i < views->n; i++)
		free(views->v[i].file);
	free(views->v);
	free(views->cameras);
	free(views->has_focal);
	*views = (struct views){ 0 };
}
