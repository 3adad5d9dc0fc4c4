#include "tests/lib/truth/clip_truth.h"

#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "base/npy/npy.h"
#include "image/video/video.h"
#include "math/stats.h"

static const char *const side_name[SIDES] = { "left", "right" };

static double *numbers(const char *dir, const char *name, const char *side, int *rows, struct err *err)
{
	char path[4096], key[100];
	struct npy array = { 0 };
	snprintf(path, sizeof path, "%s/truth.npz", dir);
	snprintf(key, sizeof key, "%s%s%s", name, side ? "_" : "", side ? side : "");
	if (!npz_read(&array, path, key, NPY_LIMIT, err))
		return NULL;
	double *out = npy_doubles(&array);
	*rows = (int)array.shape[0];
	npy_free(&array);
	return out;
}

static bool load_json(struct clip_truth *t, const char *dir, struct err *err)
{
	char path[4096];
	json_error_t fault;
	snprintf(path, sizeof path, "%s/truth.json", dir);
	json_t *root = json_load_file(path, 0, &fault);
	if (!root)
		return err_set(err, "%s: %s", path, fault.text);
	json_t *K = json_object_get(root, "K"), *centers = json_object_get(root, "eye_centre_head_cm"), *eye;
	t->focal_px = json_number_value(json_array_get(json_array_get(K, 0), 0));
	for (int k = 0; k < 2; k++)
		t->center_px[k] = json_number_value(json_array_get(json_array_get(K, (size_t)k), 2));
	t->eye_radius = 10 * json_number_value(json_object_get(root, "eye_radius_cm"));
	for (int s = 0; s < SIDES; s++)
		for (size_t k = 0; k < 3; k++)
			t->eye_center[s][k] = 10 * json_number_value(json_array_get(json_object_get(centers, side_name[s]), k));
	size_t i;
	json_array_foreach(json_object_get(root, "eyes_in_view"), i, eye)
		for (int s = 0; s < SIDES; s++)
			t->in_view[s] |= strcmp(json_string_value(eye), side_name[s]) == 0;
	json_decref(root);
	return true;
}

bool clip_truth_load(struct clip_truth *t, const char *dir, struct err *err)
{
	*t = (struct clip_truth){ 0 };
	if (!load_json(t, dir, err))
		return false;
	t->head_R = numbers(dir, "head_R", NULL, &t->frames, err);
	t->head_t = numbers(dir, "head_t", NULL, &t->frames, err);
	for (int s = 0; s < SIDES; s++) {
		if (!t->in_view[s])
			continue;
		t->gaze[s] = numbers(dir, "gaze", s ? "right_deg" : "left_deg", &t->frames, err);
		t->lid[s][LID_UPPER] = numbers(dir, "lid_upper_px", side_name[s], &t->frames, err);
		t->lid[s][LID_LOWER] = numbers(dir, "lid_lower_px", side_name[s], &t->frames, err);
		t->lid_head[s] = numbers(dir, "lid_upper_head_cm", side_name[s], &t->frames, err);
		t->openness[s] = numbers(dir, "openness", side_name[s], &t->frames, err);
	}
	return !err_is(err);
}

void clip_truth_free(struct clip_truth *t)
{
	free(t->head_R);
	free(t->head_t);
	for (int s = 0; s < SIDES; s++) {
		free(t->gaze[s]);
		free(t->lid[s][LID_UPPER]);
		free(t->lid[s][LID_LOWER]);
		free(t->lid_head[s]);
		free(t->openness[s]);
	}
	*t = (struct clip_truth){ 0 };
}

struct eye_scene clip_truth_scene(const struct clip_truth *t, const struct eye *eye, double off)
{
	struct eye_scene scene = { .width = 1280, .height = 720, .fps = 60, .eye = *eye, .head_known = true,
		.camera = { .focal_px = t->focal_px, .center_px = { t->center_px[0], t->center_px[1] } } };
	for (int s = 0; s < SIDES; s++) {
		struct eye_prior *prior = &scene.prior[s];
		prior->absent = !t->in_view[s];
		prior->radius = t->eye_radius + 0.5 * off;
		for (int k = 0; k < 3; k++) {
			prior->center_in_head[k] = t->eye_center[s][k] + (k == 1 ? -off : off);
			prior->limbus_px[k] = NAN;
			for (int c = 0; c < 2 && t->in_view[s]; c++)
				prior->canthus_in_head[c][k] = 10 * t->lid_head[s][3 * (c ? CLIP_UPPER - 1 : 0) + k];
		}
	}
	return scene;
}

void clip_truth_push(struct eye_track *track, const struct clip_truth *t, const char *dir)
{
	char path[4096];
	struct err err = { 0 };
	struct video_info info;
	snprintf(path, sizeof path, "%s/video.mp4", dir);
	struct video *video = video_open(&info, path, &(struct video_conf){ 10, 100000, 1, 0 }, &err);
	uint8_t *rgb = mem_new((size_t)(info.width * info.height), 3);
	for (int i = 0; video && i < t->frames; i++) {
		struct video_frame frame;
		bool got;
		if (!video_next(&frame, &got, video, &err) || !got)
			break;
		video_frame_rgb(rgb, 3 * info.width, &frame, 0, 0, info.width, info.height);
		struct eye_frame eye = { frame.luma, rgb, frame.luma_stride, 3 * info.width, frame.time, { { 0 } }, { 0 } };
		for (int r = 0; r < 3; r++) {
			for (int k = 0; k < 3; k++)
				eye.cam_from_head[r][k] = t->head_R[9 * i + 3 * r + k];
			eye.cam_from_head[r][3] = 10 * t->head_t[3 * i + r];
		}
		eye.cam_from_head[3][3] = 1;
		for (int s = 0; s < SIDES; s++)
			eye_track_push(track, s, &eye);
		video_frame_free(&frame);
	}
	free(rgb);
	video_close(video);
}

/* Distance of a point from a line through n points. */
static double from_line(const double p[2], int n, const double *line)
{
	double best = INFINITY;
	for (int i = 0; i + 1 < n; i++) {
		double x = line[2 * i], y = line[2 * i + 1], dx = line[2 * i + 2] - x, dy = line[2 * i + 3] - y;
		double f = fmin(1, fmax(0, ((p[0] - x) * dx + (p[1] - y) * dy) / (dx * dx + dy * dy + 1e-12)));
		best = fmin(best, hypot(p[0] - x - f * dx, p[1] - y - f * dy));
	}
	return best;
}

static void compare_lids(struct clip_truth_error *e, const struct eye_clip *clip, const struct clip_truth *t, int side)
{
	static const int points[LIDS] = { CLIP_UPPER, CLIP_LOWER };
	double *far = mem_array((size_t)clip->frames * LID_POINTS_MAX + 1, sizeof *far);
	for (int q = 0; q < LIDS; q++) {
		int n = 0;
		for (int i = 0; i < clip->frames; i++) {
			const struct eye_state *s = &clip->state[i][side];
			for (int k = 0; k < s->lid_points; k++)
				if (isfinite(s->lid[q][k][0]))
					far[n++] = from_line(s->lid[q][k], points[q], t->lid[side][q] + 2L * points[q] * i);
		}
		e->lid[q] = stats_quantile(n, far, 0.5);
		e->lid95[q] = stats_quantile(n, far, 0.95);
	}
	free(far);
}

struct clip_truth_error clip_truth_compare(const struct eye_clip *clip, const struct clip_truth *t, int side)
{
	struct clip_truth_error e = { 0 };
	double *off = mem_array((size_t)clip->frames + 1, sizeof *off);
	if (!t->in_view[side])
		return e;
	for (int k = 0; k < 3; k++) {
		int n = 0;
		for (int i = 0; i < clip->frames; i++) {
			double got = clip->state[i][side].gaze[k], open = t->openness[side][i];
			if (k == 0) {
				e.missing += open > 0.6 && !isfinite(got);
				e.invented += open < 0.15 && isfinite(got);
			}
			if (open > 0.6 && isfinite(got))
				off[n++] = fabs(got * 180 / M_PI - t->gaze[side][3 * i + k]);
		}
		e.gaze[k] = stats_quantile(n, off, 0.5);
		e.gaze95[k] = stats_quantile(n, off, 0.95);
	}
	free(off);
	compare_lids(&e, clip, t, side);
	return e;
}
