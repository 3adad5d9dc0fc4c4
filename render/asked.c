/* Pictures under a told pose and light, by the reference photograph's camera, of its size and in its own scale: its own pose and light
 * give its values. */
#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "anatomy/light.h"
#include "base/file.h"
#include "base/json.h"
#include "base/mem.h"
#include "render/render.h"

enum { FILE_LIMIT = 1 << 20, ASKED_MAX = 256, NAME_MAX_BYTES = 64 };

struct asked {
	const char *name, *environment;  // environment null: the photograph's own light
	bool posed;
	double cam_from_eye[4][4];
};

static bool good_name(const char *name)
{
	size_t n = strlen(name);
	for (size_t i = 0; i < n; i++)
		if (!isalnum((unsigned char)name[i]) && name[i] != '_' && name[i] != '-')
			return false;
	return n > 0 && n <= NAME_MAX_BYTES;
}

/* A rotation and a translation that puts the eye before the camera. */
static bool good_pose(const double m[4][4])
{
	const double tolerance = 1e-3;  // files have a few digits
	double det = m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0])
	             + m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
	bool good = fabs(det - 1) < tolerance && m[2][3] > 20 && fabs(m[3][3] - 1) < tolerance;
	for (int i = 0; i < 3; i++) {
		good = good && fabs(m[3][i]) < tolerance;
		for (int j = 0; j < 3; j++) {
			double dot = m[i][0] * m[j][0] + m[i][1] * m[j][1] + m[i][2] * m[j][2];
			good = good && fabs(dot - (i == j)) < tolerance;
		}
	}
	return good;
}

/* at: "PATH: [i]", for errors. */
static bool asked_read(struct asked *a, const json_t *entry, const char *at, struct err *err)
{
	*a = (struct asked){ 0 };
	if (!json_is_object(entry))
		return err_set(err, "%s: must be an object", at);
	const json_t *pose = json_object_get(entry, "cam_from_eye"), *light = json_object_get(entry, "environment");
	a->name = json_get_string(entry, "name", at, err);
	if (!a->name)
		return false;
	if (!good_name(a->name))
		return err_set(err, "%s: name: must be 1 to %d letters, digits, _ or -", at, NAME_MAX_BYTES);
	if (light && !json_is_null(light) && !(a->environment = json_get_string(entry, "environment", at, err)))
		return false;
	a->posed = pose && !json_is_null(pose);
	if (!a->posed)
		return true;
	if (!json_get_array(a->cam_from_eye[0], 16, entry, "cam_from_eye", at, err))
		return false;
	return good_pose(a->cam_from_eye) || err_set(err, "%s: cam_from_eye: must be a rotation and an eye at least 20 mm before the camera", at);
}

/* The light of a picture, of level 1 where it is the photograph's. */
static bool light_of(struct envmap *env, struct job *job, const struct asked *a, struct err *err)
{
	if (!light_load(env, 0, job->stage, "render.shots", a->environment, err))
		return false;
	if (job->light_level > 0)
		envmap_scale(env, 1 / job->light_level);  // one scale for all files
	else
		envmap_normalise(env);
	return true;
}

static bool picture(struct job *job, const struct asked *a, const char *rel, int n, const char *const in[], struct err *err)
{
	struct shot *own = &job->shots[job->reference], whole = *own;
	struct envmap env = { 0 };
	if (a->environment && !light_of(&env, job, a, err))
		return false;
	const struct envmap *lamps = job->conf->polarised ? 0 : a->environment ? &env : own->n_lamps ? &own->lamps : 0;
	struct envmap mirror = lamps ? shot_mirrored(lamps, &job->scene) : (struct envmap){ 0 };
	struct scene_lighting light = scene_lighting_of(a->environment ? &env : &own->env, lamps ? &mirror : 0, job->conf->lights, job->conf->light_directions);
	memcpy(whole.window, (double[4]){ 0, 0, own->fit.width, own->fit.height }, sizeof whole.window);
	whole.scale = 1;
	struct scene_view view = shot_view(&whole);
	view.samples = job->conf->samples;
	if (a->posed) {
		memcpy(view.cam_from_eye, a->cam_from_eye, sizeof view.cam_from_eye);
		memset(view.slip, 0, sizeof view.slip);
	}
	struct image rgba = scene_render(&job->scene, &view, &light, &job->count);
	shot_colour(&rgba, &job->scene);
	bool ok = pictures_save(job, 1, &(struct picture_out){ rel, &rgba }, n, in, err);
	image_free(&rgba);
	envmap_free(&mirror);
	envmap_free(&env);
	return ok;
}

static bool one(struct job *job, const json_t *entry, const char *at, struct err *err)
{
	struct asked a;
	const char *in[COUNT(job->in) + 2];
	int n = job->n_in;
	if (!asked_read(&a, entry, at, err))
		return false;
	memcpy(in, job->in, sizeof job->in);
	in[n++] = job->conf->shots;
	if (a.environment) {
		char *inside = 0;
		if (!file_inside(&inside, job->stage->capture, a.environment, err))
			return err_wrap(err, "%s", at);
		free(inside);
		in[n++] = a.environment;
	}
	const char *rel = stage_path(job->stage, "%s/shot_%s.exr", job->names->render, a.name) + strlen(job->stage->capture) + 1;
	if (stage_fresh(job->stage, rel, n, in))
		return true;
	return job_ready(job, err) && shot_ready(job, &job->shots[job->reference], err) && picture(job, &a, rel, n, in, err);
}

bool asked_pictures(struct job *job, struct err *err)
{
	char *inside = 0;
	if (!job->conf->shots)
		return true;
	if (!file_inside(&inside, job->stage->capture, job->conf->shots, err))
		return err_wrap(err, "render.shots");
	free(inside);
	const char *path = stage_path(job->stage, "%s", job->conf->shots);
	json_t *list = json_read_array(path, FILE_LIMIT, err), *entry;
	bool ok = list;
	if (ok && json_array_size(list) > ASKED_MAX)
		ok = err_set(err, "%s: %zu pictures: at most %d", path, json_array_size(list), ASKED_MAX);
	size_t i;
	json_array_foreach(list, i, entry) {
		char *at = mem_printf("%s: [%zu]", path, i);
		ok = ok && one(job, entry, at, err);
		free(at);
	}
	json_decref(list);
	return ok;
}
