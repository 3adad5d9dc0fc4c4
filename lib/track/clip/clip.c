#include "track/clip/clip.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "bridge/cv_face.h"
#include "optics/camera_rig.h"
#include "track/clip/look.h"
#include "track/clip/moves.h"

static const char *const marks[] = { "left_inner_canthus",  "left_outer_canthus",  "left_upper_lid_mid",  "left_lower_lid_mid",
	                                 "right_inner_canthus", "right_outer_canthus", "right_upper_lid_mid", "right_lower_lid_mid" };

bool track_video(char file[320], int *others, struct stage *stage, struct err *err)
{
	struct file_list list;
	file[0] = 0;
	if (!stage_list(stage, &list, "video", err))
		return false;
	*others = list.n - 1;
	if (list.n > 0)
		snprintf(file, 320, "video/%s", list.names[0]);
	bool ok = list.n > 0 || err_set(err, "video/: holds no file: film the eyes, close, looking around and blinking");
	file_list_free(&list);
	return ok;
}

long track_frames_of(const struct track_clip *clip, long n)
{
	return clip->info.fps > 60 ? lround((double)n * clip->info.fps / 60) : n;
}

/* Poses of the head estimated by calibrate, in its own mesh's frame. */
static void take_poses(struct track_clip *clip, const struct camera_rig *rig)
{
	for (int i = 0; i < rig->n; i++) {
		const struct rig_camera *c = &rig->cameras[i];
		if (strcmp(c->file, clip->file) || c->frame < 0 || !c->has_pose)
			continue;
		clip->known = mem_grow(clip->known, (size_t)clip->n_known + 1, sizeof *clip->known);
		struct track_known *k = &clip->known[clip->n_known++];
		*k = (struct track_known){ c->frame, .residual_px = c->residual_px };
		memcpy(k->cam_from_head, c->cam_from_head, sizeof k->cam_from_head);
	}
}

static bool set_camera(struct track_clip *clip, struct stage *stage, const struct track_subject *s, const struct track_conf *conf,
                       struct err *err)
{
	struct camera *c = &clip->camera;
	if (!camera_keys_agree(&conf->camera, clip->info.width, clip->info.height, err))
		return false;
	*c = (struct camera){ .focal_px = camera_keys_focal(&conf->camera, clip->info.width, clip->info.height),
	                      .center_px = { 0.5 * clip->info.width, 0.5 * clip->info.height }, .source = CAMERA_CONF };
	memcpy(c->distortion, conf->camera.distortion, sizeof c->distortion);
	if (isfinite(conf->camera.center_px[0]))
		memcpy(c->center_px, conf->camera.center_px, sizeof c->center_px);
	struct camera_rig rig = { 0 };
	const char *path = stage_path(stage, "work/rig.json");
	if (isnan(c->focal_px) && file_exists(path)) {
		if (!camera_rig_load(&rig, path, err))
			return false;
		const struct rig_camera *found = camera_rig_find(&rig, clip->file);
		if (found && found->width == clip->info.width && found->height == clip->info.height) {
			*c = found->camera;
			if (s->file && !strncmp(s->file, "work/", 5))
				take_poses(clip, &rig);
		}
		camera_rig_free(&rig);
	}
	// The widest picture a face is filmed in, as if from the usual distance: scaled when the eyes are found.
	clip->focal_assumed = isnan(c->focal_px);
	if (clip->focal_assumed)
		*c = (struct camera){ .focal_px = 4.0 * clip->info.width, .center_px = { c->center_px[0], c->center_px[1] }, .source = CAMERA_NONE };
	return camera_keys_check(c, clip->info.width, clip->info.height, err);
}

/* Landmarks marked in the picture of the reference frame. */
static bool pose_from_marks(struct track_clip *clip, const struct track_subject *s, const struct track_conf *conf, struct err *err)
{
	struct head_sight sights[COUNT(marks)] = { 0 };
	int n = 0;
	for (int i = 0; i < conf->landmark_px.n; i++) {
		int k = 0;
		while (k < COUNT(marks) && strcmp(marks[k], conf->landmark_px.items[i].name))
			k++;
		int row = k < COUNT(marks) ? s->mark[k / MARKS][k % MARKS] : -1;
		if (row < 0)
			return err_set(err, "capture.conf: track.landmark_%s: needs subject.landmark.%s, a row of the mesh",
			               conf->landmark_px.items[i].name, conf->landmark_px.items[i].name);
		sights[n] = (struct head_sight){ .weight = 1, .px = { conf->landmark_px.items[i].value[0], conf->landmark_px.items[i].value[1] } };
		for (int c = 0; c < 3; c++)
			sights[n].head[c] = s->mesh.vertices[row][c];
		clip->eye_seen[k / MARKS] = true;
		n++;
	}
	if (n < 4)
		return err_set(err, "capture.conf: track.landmark_*: %d marked, at least 4 are needed", n);
	// Start: facing the camera, at the distance given by the spread of the marks.
	double at[2] = { 0 }, mid[3] = { 0 }, px = 0, mm = 0, R[3] = { 1, -1, -1 };
	for (int i = 0; i < n; i++)
		for (int c = 0; c < 3; c++) {
			mid[c] += sights[i].head[c] / n;
			at[c % 2] += c < 2 ? sights[i].px[c] / n : 0;
		}
	for (int i = 0; i < n; i++) {
		px += pow(sights[i].px[0] - at[0], 2) + pow(sights[i].px[1] - at[1], 2);
		mm += pow(sights[i].head[0] - mid[0], 2) + pow(sights[i].head[1] - mid[1], 2);
	}
	double z = clip->camera.focal_px * sqrt(mm / fmax(px, 1e-9)), ray[3];
	struct head_prior prior = { .sigma = { 0.15, 0.15, INFINITY, INFINITY, INFINITY, INFINITY } };
	camera_ray(ray, &clip->camera, at);
	for (int c = 0; c < 3; c++) {
		prior.cam_from_head[c][c] = R[c];
		prior.cam_from_head[c][3] = ray[c] / ray[2] * z - R[c] * mid[c];
	}
	prior.cam_from_head[3][3] = 1;
	memcpy(clip->cam_from_head, prior.cam_from_head, sizeof clip->cam_from_head);
	clip->pose_px = head_pose_fit(clip->cam_from_head, n, sights, &clip->camera, INFINITY, &prior);
	double turned[3];
	if (head_pose_sigma(turned, clip->cam_from_head, n, sights, &clip->camera, INFINITY, &prior))
		memcpy(clip->turn_sigma, turned, sizeof clip->turn_sigma);
	clip->pose_given = true;
	if (isnan(clip->pose_px) || clip->pose_px > 0.03 * clip->info.width)
		return err_set(err, "capture.conf: track.landmark_*: no pose of %s brings them together (rms %.0f px): look for one that is misplaced",
		               s->file, clip->pose_px);
	return true;
}

static bool is_known(const struct track_clip *clip, long frame)
{
	for (int i = 0; i < clip->n_known; i++)
		if (clip->known[i].frame == frame)
			return true;
	return false;
}

static void keep(struct track_clip *clip, const struct video_frame *f)
{
	for (int y = 0; y < f->height; y++)
		memcpy(clip->luma + (long)y * f->width, f->luma + (long)y * f->luma_stride, (size_t)f->width);
	video_frame_rgb(clip->rgb, 3 * f->width, f, 0, 0, f->width, f->height);
	clip->reference = f->index;
}

/* Finds the head in the kept frame. */
static bool try_frame(struct track_clip *clip, bool known, const struct track_subject *s, const struct track_conf *conf, struct err *err)
{
	if (known)
		return track_look_known(clip, clip->reference, s, conf);
	return conf->landmark_px.n > 0 ? pose_from_marks(clip, s, conf, err) : track_look(clip, s->assumed ? WAY_UP : WAY_EITHER, s, conf);
}

/* Decodes up to the reference frame: the one configured, or the first in which eyes are found. known: only frames of known pose
 * are tried, and finding none is no error. */
static bool find_reference(struct track_clip *clip, struct video *video, bool known, const struct track_subject *s,
                           const struct track_conf *conf, struct err *err)
{
	enum { EVERY = 5 };
	bool found = false, any = false;
	const long search = track_frames_of(clip, conf->search), every = track_frames_of(clip, EVERY);
	for (long i = 0; !found && (conf->reference >= 0 ? i <= conf->reference : i < search); i++) {
		struct video_frame f;
		bool got;
		if (!video_next(&f, &got, video, err))
			return false;
		if (!got)
			break;
		if (known ? is_known(clip, i) : conf->reference >= 0 ? i == conf->reference : i % every == 0) {
			keep(clip, &f);
			any = true;
			found = try_frame(clip, known, s, conf, err);
		}
		video_frame_free(&f);
		if (err_is(err))
			return false;
	}
	if (known)
		return found;
	if (!any && clip->info.frames < 2)
		return err_set(err, "%s: %ld frames: film longer, or copy the file again, whole", clip->file, clip->info.frames);
	if (!any && conf->reference < 0)
		return err_set(err, "%s: none of its first frames can be decoded: copy the file again, whole", clip->file);
	if (!any)
		return err_set(err, "%s: %ld frames: track.reference_frame = %d is none of them", clip->file, clip->info.frames, conf->reference);
	return found || err_set(err, "%s: no face with open eyes in %s: film the face from in front, upright, eyes open at the start; or mark the corners of the eyes (track.landmark_left_inner_canthus = x y ...)",
	                        clip->file, conf->reference >= 0 ? "the reference frame" : "its first frames");
}

bool track_clip_take(struct track_clip *clip, long frame, struct stage *stage, const struct track_conf *conf, struct err *err)
{
	struct video_info info;
	struct video *video = video_open(&info, stage_path(stage, "%s", clip->file), &conf->video, err);
	bool got = video;
	for (long i = 0; got && i <= frame; i++) {
		struct video_frame f;
		got = video_next(&f, &got, video, err) && got;
		if (got && i == frame)
			keep(clip, &f);
		video_frame_free(&f);
	}
	video_close(video);
	return got;
}

bool track_clip_open(struct track_clip *clip, struct stage *stage, const struct track_subject *s, const struct track_conf *conf,
                     struct err *err)
{
	clip->pose_px = clip->skin_mm = NAN;
	struct video *video = video_open(&clip->info, stage_path(stage, "%s", clip->file), &conf->video, err);
	bool ok = video && set_camera(clip, stage, s, conf, err);
	size_t area = (size_t)clip->info.width * (size_t)clip->info.height;
	clip->luma = mem_new(area + 1, 1);
	clip->rgb = mem_new(3 * area + 1, 1);
	bool known = ok && clip->n_known && conf->reference < 0 && !conf->landmark_px.n;
	bool found = known && find_reference(clip, video, true, s, conf, err);
	if (known && !found && !err_is(err)) {
		video_close(video);
		video = video_open(&clip->info, stage_path(stage, "%s", clip->file), &conf->video, err);
	}
	ok = found || (ok && video && !err_is(err) && find_reference(clip, video, false, s, conf, err));
	video_close(video);
	return ok;
}

void track_clip_free(struct track_clip *clip)
{
	free(clip->luma);
	free(clip->rgb);
	free(clip->known);
	track_moves_free(&clip->moves);
	cv_face_close(clip->faces);
}

void track_to_model(float out[2], const double px[2], const double head[3], const double pose[4][4], const struct track_clip *clip)
{
	double p[3], ray[3], h[3], model[2] = { NAN, NAN };
	head_from(p, pose, head);
	camera_ray(ray, &clip->camera, px);
	for (int k = 0; k < 3; k++)
		ray[k] *= p[2] / ray[2];
	head_to(h, pose, ray);
	head_project(model, &clip->camera, clip->cam_from_head, h);
	out[0] = (float)model[0];
	out[1] = (float)model[1];
}
