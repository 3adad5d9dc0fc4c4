#include "sfm/frames.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/json.h"
#include "base/mem.h"
#include "base/record.h"
#include "image/video/video.h"
#include "sfm/match/frames.h"

#define CHOSEN CALIBRATE_DIR "/frames.json"

struct look {
	double *sharpness, *change;
	long n;
};

/* Measures every frame: its sharpness, and its difference from the one before. */
static bool look_through(struct look *look, struct video *video, const struct video_info *info, struct stage *stage, struct err *err)
{
	uint8_t thumb[2][THUMB * THUMB];
	bool got = true;
	*look = (struct look){ mem_new((size_t)info->frames + 1, sizeof(double)), mem_new((size_t)info->frames + 1, sizeof(double)), 0 };
	while (got && look->n < info->frames) {
		struct video_frame f;
		if (!video_next(&f, &got, video, err))
			return false;
		if (got) {
			uint8_t *px = mem_array((size_t)f.width * (size_t)f.height, 1);
			for (int y = 0; y < f.height; y++)
				memcpy(px + (long)y * f.width, f.luma + (long)y * f.luma_stride, (size_t)f.width);
			view_thumb(thumb[look->n % 2], px, f.width, f.height, 1);
			look->sharpness[look->n] = view_sharpness(px, f.width, f.height, 1);
			look->change[look->n] = look->n ? view_difference(thumb[0], thumb[1]) : 0;
			free(px);
			look->n++;
			stage_progress(stage, (int)look->n, (int)info->frames, "frames of the video");
		}
		video_frame_free(&f);
	}
	return true;
}

/* Reads the selection that an earlier run made from the same file; returns how many frames, 0 where there is none. */
static int recall(long *chosen, int want, const char *key, struct stage *stage)
{
	enum { LIMIT = 1 << 20 };
	struct err none = { 0 };
	json_t *json = file_exists(stage_path(stage, CHOSEN)) ? json_read(stage_path(stage, CHOSEN), LIMIT, &none) : 0;
	const json_t *list = json_object_get(json, key);
	int n = (int)json_array_size(list);
	for (int i = 0; i < n && n <= want; i++)
		chosen[i] = (long)json_integer_value(json_array_get(list, (size_t)i));
	json_decref(json);
	return n <= want ? n : 0;
}

static bool keep(const long *chosen, int n, const char *key, struct stage *stage, struct err *err)
{
	json_t *list = json_array();
	for (int i = 0; i < n; i++)
		json_array_append_new(list, json_integer(chosen[i]));
	json_t *json = json_pack("{s:o}", key, list);
	bool ok = json_write(stage_path(stage, CHOSEN), json, 0, err);
	json_decref(json);
	return ok;
}

static int choose(long *chosen, int want, const char *file, const char *key, const struct video_conf *conf, struct stage *stage,
                  const struct calibrate_options *o, struct err *err)
{
	int n = recall(chosen, want, key, stage);
	if (n)
		return n;
	struct video_info info;
	struct look look = { 0 };
	struct video *video = video_open(&info, stage_path(stage, "%s", file), conf, err);
	if (video && look_through(&look, video, &info, stage, err)) {
		n = sfm_choose_frames(chosen, want, look.n, look.sharpness, look.change, fmax(o->same_level, 0.1));
		stage_note(stage, "%s: %d of %ld frames taken, spread and sharp; the rest show much the same", file, n, look.n);
	}
	video_close(video);
	free(look.sharpness);
	free(look.change);
	if (n && !keep(chosen, n, key, stage, err))
		n = 0;
	return n;
}

/* Decodes the video and writes the pictures of views[0..n), which stand in the order of their frames. */
static bool decode(struct view *views, int n, const struct video_conf *conf, struct stage *stage, const struct calibrate_options *o,
                   struct err *err)
{
	struct video_info info;
	struct video *video = video_open(&info, stage_path(stage, "%s", views[0].file), conf, err);
	bool ok = video, got = true;
	for (int next = 0; ok && got && next < n;) {
		struct video_frame f;
		ok = video_next(&f, &got, video, err);
		if (ok && got && f.index == views[next].frame) {
			struct view *v = &views[next++];
			uint8_t *rgb = mem_array((size_t)f.width * (size_t)f.height, 3);
			video_frame_rgb(rgb, 3 * f.width, &f, 0, 0, f.width, f.height);
			v->width = f.width;
			v->height = f.height;
			ok = view_picture(v, stage_path(stage, CALIBRATE_DIR "/pictures/%s", v->picture), rgb, 3, o->picture_px, err);
			free(rgb);
		}
		video_frame_free(&f);
	}
	video_close(video);
	for (int i = 0; i < n && ok; i++)
		if (!views[i].picture_width)
			snprintf(views[i].reason, sizeof views[i].reason, "cannot be decoded");
	return ok;
}

static void append(struct views *views, int n, const long *chosen, const char *file, const char *hash, int picture_px)
{
	views->v = mem_grow(views->v, (size_t)(views->n + n), sizeof *views->v);
	for (int i = 0; i < n; i++) {
		struct view *v = &views->v[views->n++];
		*v = (struct view){ .file = mem_str(file), .focal_px = NAN, .frame = chosen[i] };
		snprintf(v->picture, sizeof v->picture, "%.16s-%d-%ld.jpg", hash, picture_px, chosen[i]);
		// The file stands for the camera: its frames share one lens, with no other picture.
		snprintf(v->maker, sizeof v->maker, "%.63s", file);
	}
}

bool frames_add(struct views *views, int n, const struct pictures *known, struct stage *stage, const struct calibrate_options *o,
                struct err *err)
{
	struct video_conf conf = o->video;
	conf.threads = stage->threads;
	struct file_list list;
	struct err why = { 0 };
	if (!stage_list(stage, &list, "video", err))
		return false;
	char *file = list.n ? mem_printf("video/%s", list.names[0]) : 0;
	const char *hash = file ? record_hash(stage->record, file) : 0;
	file_list_free(&list);
	bool ok = true;
	if (hash && n > 0) {
		char *key = mem_printf("%s %d %.9g", hash, n, o->same_level);
		long *chosen = mem_new((size_t)n, sizeof *chosen);
		int first = views->n, found = choose(chosen, n, file, key, &conf, stage, o, &why);
		if (err_is(&why))
			stage_skipped(stage, "%s", why.msg);
		append(views, found, chosen, file, hash, o->picture_px);
		pictures_recall(views, known);
		bool stand = true;
		for (int i = first; i < views->n; i++)
			stand &= views->v[i].picture_width && file_exists(stage_path(stage, CALIBRATE_DIR "/pictures/%s", views->v[i].picture));
		ok = stand || decode(&views->v[first], found, &conf, stage, o, err);
		free(chosen);
		free(key);
	}
	free(file);
	return ok;
}
