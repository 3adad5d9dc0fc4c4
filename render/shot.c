/* The photographs of an eye: those that have a fit, the reference among them; their decoding. */
#include <stdlib.h>
#include <string.h>

#include "anatomy/light.h"
#include "base/json.h"
#include "base/mem.h"
#include "bridge/cv_blur.h"
#include "draw/eye/tint.h"
#include "draw/photo/reference.h"
#include "image/photo/photo.h"
#include "render/render.h"
#include "tissue/light/sclera_light.h"

bool shots_load(struct job *job, const struct capture *capture, int eye_index, struct err *err)
{
	const char *texture = stage_path(job->stage, "%s/texture.json", job->names->iris);
	job->shots = mem_new((size_t)capture->n_photos, sizeof *job->shots);
	for (int i = 0; i < capture->n_photos; i++) {
		const struct capture_photo *photo = &capture->photos[i];
		const char *path = stage_path(job->stage, "%s", photo->fit);
		if (photo->eye != eye_index)
			continue;
		struct shot shot = { .photo = photo };
		if (!file_exists(path)) {
			stage_skipped(job->stage, "%s: it has no fit", photo->name);
			continue;
		}
		if (!fit_load(&shot.fit, path, err) || !shot_align(&shot, texture, err))
			return false;
		if (!shot.fit.ok) {
			stage_skipped_as_said(job->stage, "%s: its fit was rejected: %s", photo->name, shot.fit.reason);
			continue;
		}
		shot_window(&shot, job->conf->photo_px);
		if (!(shot.window[2] - shot.window[0] >= 16 && shot.window[3] - shot.window[1] >= 16)) {
			stage_skipped(job->stage, "%s: the eye lies outside the photograph", photo->name);
			continue;
		}
		job->shots[job->n_shots] = shot;
		if (shot_merit(&shot.fit) > shot_merit(&job->shots[job->reference].fit))
			job->reference = job->n_shots;
		job->n_shots++;
	}
	return true;
}

/* What each pixel round the eye shows: where its white is. */
static bool ask(struct shot *shot, const struct photo *photo, struct err *err)
{
	const struct ellipse *e = &shot->fit.limbus;
	struct evidence_net *net;
	if (!evidence_open_shipped(&net, err))
		return false;
	const bool ok = evidence_window(&shot->told, net, photo, e->cx, e->cy, e->a, err);
	evidence_close(net);
	return ok;
}

static bool decode(struct job *job, struct shot *shot, struct err *err)
{
	struct photo photo;
	if (!photo_load(&photo, stage_path(job->stage, "%s", shot->photo->file), job->conf->limit_mpx, err))
		return false;
	const double *w = shot->window;
	bool ok = photo.width == shot->fit.width && photo.height == shot->fit.height;
	if (!ok)
		err_set(err, "%s: %d x %d px, but its fit is of %d x %d: run limbus again", shot->photo->file, photo.width,
		        photo.height, shot->fit.width, shot->fit.height);
	if (ok) {
		enum { LARGE = 32000000 };  // pixels; in floating point 400 MB
		const int x = (int)w[0], y = (int)w[1], width = (int)(w[2] - w[0]), height = (int)(w[3] - w[1]);
		struct scene_view v = shot_view(shot);
		if ((long)width * height > LARGE && v.width < width && v.height < height) {
			shot->image = photo_shrunk(&photo, x, y, width, height, v.width, v.height);
		} else {
			struct image all = photo_linear(&photo, x, y, width, height);
			shot->image = image_new(v.width, v.height, 3);
			ok = cv_resize(shot->image.px, v.width, v.height, all.px, all.width, all.height, 3, err);
			image_free(&all);
		}
	}
	if (ok && shot == &job->shots[job->reference])
		ok = ask(shot, &photo, err);
	photo_free(&photo);
	return ok;
}

int env_height(const struct render_conf *conf)
{
	return conf->scene.map_size > 1024 ? 512 : conf->scene.map_size > 512 ? 256 : 128;
}

/* The shading of a photograph's sclera, by which pigment was fitted. False where that says nothing. */
static bool shading_of(struct sclera_light *light, const struct job *job, const struct shot *shot)
{
	struct err unread = { 0 };
	const char *path = stage_path(job->stage, "%s/pigment.json", job->names->iris);
	json_t *root = file_exists(path) ? json_read(path, 1 << 22, &unread) : 0, *photo;
	size_t i;
	bool found = false;
	*light = (struct sclera_light){ 0 };
	json_array_foreach(json_object_get(json_object_get(root, "light"), "photos"), i, photo) {
		const char *name = json_string_value(json_object_get(photo, "name"));
		if (name && !strcmp(name, shot->photo->name))
			found = json_get_array(light->slope, 2, photo, "slope", path, &unread);
	}
	json_decref(root);
	return found;
}

/* The light of a decoded photograph: told, or estimated from it. Where the cornea mirrors no lamp it is the light that pigment was fitted under,
 * or else another model would be shown than the one that was fitted. */
static bool light(struct job *job, struct shot *shot, struct err *err)
{
	const int rows = env_height(job->conf);
	struct sclera_light shading;
	struct scene_white white;
	if (!scene_white(&white, stage_path(job->stage, "%s", job->in[3]), err))
		return false;
	if (job->conf->polarised)
		shot->env = light_studio(rows);
	else
		shot->env = light_of_photo(shot, job->eye, rows, white.rgb, white.told, &shot->lamps, &shot->n_lamps);
	if (job->conf->light) {
		envmap_free(&shot->env);
		if (!light_load(&shot->env, &job->light_level, job->stage, "light.environment", job->conf->light, err))
			return false;
		envmap_normalise(&shot->env);
		return true;
	}
	if (shot->n_lamps > 0 || !shading_of(&shading, job, shot))
		return true;
	envmap_free(&shot->env);
	shot->env = sclera_light_environment(&shading, rows);
	return true;
}

bool shot_ready(struct job *job, struct shot *shot, struct err *err)
{
	if (shot->image.px)
		return true;
	if (!decode(job, shot, err))
		return false;
	return light(job, shot, err);
}

void shot_done(struct shot *shot)
{
	image_free(&shot->image);
	evidence_free(&shot->told);
	envmap_free(&shot->env);
	envmap_free(&shot->lamps);
	shot->image = (struct image){ 0 };
	shot->env = shot->lamps = (struct envmap){ 0 };
	shot->n_lamps = 0;
}

void shots_free(struct job *job)
{
	for (int i = 0; i < job->n_shots; i++)
		shot_done(&job->shots[i]);
	free(job->shots);
}

struct envmap shot_mirrored(const struct envmap *mirror, const struct scene *scene)
{
	const double *w = scene->photo_white;
	return envmap_tinted(mirror, (double[3]){ 1 / w[0], 1 / w[1], 1 / w[2] });
}

void shot_colour(struct image *rgba, const struct scene *scene)
{
	for (long i = 0; i < (long)rgba->width * rgba->height; i++)
		for (int c = 0; c < 3; c++)
			rgba->px[i * rgba->channels + c] *= (float)scene->photo_white[c];
}
