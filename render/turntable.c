/* For other programs: the eye turned to and fro as a film, and the layers of a picture. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "draw/eye/surface.h"
#include "draw/studio.h"
#include "image/exr.h"
#include "image/video/video.h"
#include "render/render.h"

enum { SECONDS = 4, FPS = 30 };

static bool film(struct job *job, struct video_writer *w, struct err *err)
{
	struct scene_lighting light = scene_lighting_of(&job->studio, &job->studio, job->conf->lights, job->conf->light_directions);
	bool ok = true;
	for (int i = 0; ok && i < SECONDS * FPS; i++) {
		double yaw = job->conf->frame_deg * M_PI / 180 * sin(2 * M_PI * i / (SECONDS * FPS));  // it begins again where it ends
		struct scene_view view = scene_view_turned(&job->scene, yaw, 0, job->conf->field_mm, job->conf->frame_px);
		view.samples = job->conf->samples;
		struct image rgba = scene_render(&job->scene, &view, &light, &job->count), seen = studio_on_grey(&rgba, job->gain, &job->conf->finish);
		uint8_t *px = image_to_srgb8(&seen);
		ok = video_writer_put(w, px, (double)i / FPS, err);
		free(px);
		image_free(&seen);
		image_free(&rgba);
	}
	return ok;
}

bool turntable_film(struct job *job, const char *rel, struct err *err)
{
	if (!job->conf->film) {
		stage_skipped(job->stage, "%s: film = no", rel);
		return true;
	}
	if (stage_fresh(job->stage, rel, job->n_in, job->in))
		return true;
	if (!job_ready(job, err))
		return false;
	struct video_writer_conf conf = { .width = job->conf->frame_px, .height = job->conf->frame_px, .fps = FPS, .crf = 18,
		                              .made_by = stage_made_by(job->stage, job->n_in, job->in) };
	struct video_writer *w = video_writer_open(stage_path(job->stage, "%s", rel), &conf, err);
	bool ok = w && film(job, w, err);
	return video_writer_close(w, ok, err) && ok && stage_made(job->stage, rel, job->n_in, job->in, err);
}

bool layers_save(struct job *job, const char *rel, const struct image *full, const struct image *diffuse, const struct scene_view *view, struct err *err)
{
	static const char *const names[] = { "N.X", "N.Y", "N.Z", "Z", "diffuse.B", "diffuse.G", "diffuse.R", "specular.B", "specular.G", "specular.R" };
	struct image surface = scene_surface(&job->scene, view), out = image_new(full->width, full->height, COUNT(names));
	for (long i = 0; i < (long)full->width * full->height; i++) {
		float *to = out.px + COUNT(names) * i;
		memcpy(to, surface.px + 4 * i + 1, 3 * sizeof *to);
		to[3] = surface.px[4 * i];
		for (int c = 0; c < 3; c++) {
			to[4 + c] = diffuse->px[4 * i + 2 - c];
			to[7 + c] = full->px[4 * i + 2 - c] - diffuse->px[4 * i + 2 - c];
		}
	}
	struct exr_info info = { .made_by = stage_made_by(job->stage, job->n_in, job->in) };
	bool ok = exr_write(stage_path(job->stage, "%s", rel), &out, names, EXR_HALF, &info, err)
	          && stage_made(job->stage, rel, job->n_in, job->in, err);
	image_free(&surface);
	image_free(&out);
	return ok;
}
