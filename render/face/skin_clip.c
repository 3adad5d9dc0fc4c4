/* Moving pictures of a driven character. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "bridge/cv_photo.h"
#include "draw/studio.h"
#include "math/vec.h"
#include "render/face/skin.h"

static const char gaze_csv[] = "work/skin/gaze.csv", script_csv[] = "work/skin/animation.csv";

static const char *output(struct skin_job *job, const char *name, const char *suffix)
{
	return stage_path(job->stage, "work/render/%s%s", name, suffix) + strlen(job->stage->capture) + 1;
}

/* A clip while it is drawn. */
struct clip {
	struct skin_job *job;
	struct skin_target *t;
	const struct drive *drive;
	struct portrait *portrait;
	struct portrait_view view;
	struct video *video;            // or null
	struct video_frame frame;       // of the input
	struct video_writer *writer;
	uint8_t *rgb, *input;           // the output picture; the input's, as large as it is filmed
	int width, input_width;         // of the output; of the input's part in it
	int step;
};

/* Reads the input up to the frame of that number and puts it, reduced, into the left part of the picture. */
static bool put_input(struct clip *c, int number, struct err *err)
{
	bool got = true;
	while (got && (!c->frame.luma || c->frame.index < number)) {
		if (c->frame.luma)
			video_frame_free(&c->frame);
		if (!video_next(&c->frame, &got, c->video, err))
			return false;
	}
	if (!got || c->frame.index != number)
		return true;  // the one before stays
	int w = c->frame.width, h = c->frame.height, height = c->view.height;
	c->input = c->input ? c->input : mem_array((size_t)w * (size_t)h * 3, 1);
	video_frame_rgb(c->input, 3 * w, &c->frame, 0, 0, w, h);
	uint8_t *small = cv_resize8(c->input, w, h, 3, c->input_width, height);
	for (int y = 0; y < height; y++)
		memcpy(c->rgb + 3L * y * c->width, small + 3L * y * c->input_width, 3 * (size_t)c->input_width);
	free(small);
	return true;
}

static void put_face(struct clip *c, const double *controls, bool first)
{
	portrait_pose(c->portrait, controls);
	portrait_light(c->portrait, &c->view, first);
	struct image rgba = portrait_draw(c->portrait, &c->view), seen = studio_on_grey(&rgba, c->job->gain, &c->job->render->finish);
	uint8_t *px = image_to_srgb8(&seen);
	for (int y = 0; y < c->view.height; y++)
		memcpy(c->rgb + 3 * ((long)y * c->width + c->input_width), px + 3L * y * c->view.width, 3 * (size_t)c->view.width);
	free(px);
	image_free(&seen);
	image_free(&rgba);
}

static bool frames(struct clip *c, struct err *err)
{
	const struct drive *d = c->drive;
	for (int f = 0; f < d->n && d->time[f] - d->time[0] <= c->job->conf->clip_seconds; f += c->step) {
		if (c->video && !put_input(c, f, err))
			return false;
		put_face(c, drive_at(d, f), f == 0);
		if (!video_writer_put(c->writer, c->rgb, d->time[f] - d->time[0], err))
			return false;
		stage_progress(c->job->stage, f + 1, d->n, "clip");
	}
	return true;
}

/* Every how many frames one is drawn, so that there are at most `fps` a second. */
static int step_of(const struct drive *d, double fps)
{
	double mean = d->n > 1 ? (d->time[d->n - 1] - d->time[0]) / (d->n - 1) : 1;
	return (int)fmax(ceil(1 / (fps * mean) - 0.01), 1);
}

static bool clip_make(struct clip *c, const char *rel, int n_in, const char *const in[], struct err *err)
{
	const struct skin_conf *conf = c->job->conf;
	struct portrait_conf draw = skin_portrait(c->job, c->t);
	draw.samples = conf->clip_samples;
	draw.eye_samples = 1;
	draw.lights = draw.lights > 8 ? 8 : draw.lights;  // shadows as sharp as its pixels show them
	draw.subdivide = draw.subdivide < 1 ? draw.subdivide : 1;
	c->step = step_of(c->drive, conf->clip_fps);
	c->width = c->input_width + c->view.width;
	c->rgb = mem_new((size_t)c->width * (size_t)c->view.height * 3, 1);
	c->portrait = portrait_new(&c->t->rig, c->job->eyes, &c->job->studio, &draw);
	portrait_wear(c->portrait, &c->job->wrinkles, c->job->model.n_au, c->job->model.au_names);
	double mean = c->drive->n > 1 ? (c->drive->time[c->drive->n - 1] - c->drive->time[0]) / (c->drive->n - 1) : 1;
	struct video_writer_conf w = { .width = c->width, .height = c->view.height, .fps = 1 / (mean * c->step), .crf = conf->clip_crf,
		                           .preset = "veryfast", .made_by = stage_made_by(c->job->stage, n_in, in) };
	c->writer = video_writer_open(stage_path(c->job->stage, "%s", rel), &w, err);
	bool ok = c->writer && frames(c, err);
	ok = video_writer_close(c->writer, ok, err) && ok && skin_made(c->job, rel, n_in, in, err);
	if (c->frame.luma)
		video_frame_free(&c->frame);
	portrait_free(c->portrait);
	free(c->rgb);
	free(c->input);
	return ok;
}

/* The modelling camera's view, so many px wide. */
static struct portrait_view input_view(const struct rig *rig, int width)
{
	const struct rig_camera *cam = &rig->camera;
	double k = (double)width / cam->width;
	struct portrait_view v = { .focal_px = k * cam->focal_px[0], .center_px = { k * cam->center_px[0], k * cam->center_px[1] },
		                       .width = width, .height = (int)lrint(k * cam->height) };
	memcpy(v.cam_from_target, cam->from_target, sizeof v.cam_from_target);
	return v;
}

static bool driven(struct skin_job *job, struct skin_target *t, struct err *err)
{
	const char *in[COUNT(t->in) + 2], *rel = output(job, t->name, "_clip.mp4");
	int n = t->n_in;
	struct drive drive;
	struct video_info info;
	memcpy(in, t->in, sizeof t->in);
	in[n++] = gaze_csv;
	in[n++] = job->video;
	if (skin_kept(job, rel, n, in, err))
		return true;
	if (!skin_open(job, t, err) || !drive_load(&drive, &job->model, stage_path(job->stage, "%s", gaze_csv), err))
		return false;
	struct clip c = { .job = job, .t = t, .drive = &drive, .view = input_view(&t->rig, job->conf->clip_px), .input_width = job->conf->clip_px };
	c.video = video_open(&info, stage_path(job->stage, "%s", job->video), &job->conf->video, err);
	bool ok = c.video && clip_make(&c, rel, n, in, err);
	video_close(c.video);
	drive_free(&drive);
	return ok;
}

static bool scripted(struct skin_job *job, struct skin_target *t, struct err *err)
{
	const char *in[COUNT(t->in) + 1], *rel = output(job, t->name, "_script.mp4");
	int n = t->n_in;
	struct drive drive;
	double d[3];
	memcpy(in, t->in, sizeof t->in);
	in[n++] = script_csv;
	if (skin_kept(job, rel, n, in, err))
		return true;
	if (!skin_open(job, t, err) || !drive_load(&drive, &job->model, stage_path(job->stage, "%s", script_csv), err))
		return false;
	vec_add(d, t->rig.globe[0].center, -1, t->rig.globe[1].center);
	struct clip c = { .job = job, .t = t, .drive = &drive };
	c.view = portrait_front(&t->rig, -1, job->conf->field * vec_norm(d), 0, 0, job->conf->clip_px, job->conf->clip_px * 9 / 16);
	bool ok = clip_make(&c, rel, n, in, err);
	drive_free(&drive);
	return ok;
}

bool skin_clips(struct skin_job *job, struct skin_target *t, struct err *err)
{
	bool gaze = file_exists(stage_path(job->stage, "%s", gaze_csv)), script = file_exists(stage_path(job->stage, "%s", script_csv));
	bool clips = job->conf->clip_px > 0, ok = true;
	if (clips && gaze && job->video)
		ok = driven(job, t, err);
	if (ok && clips && script)
		ok = scripted(job, t, err);
	if (ok && (gaze || script))
		ok = skin_glb(job, t, script ? script_csv : gaze_csv, err);
	return ok;
}
