/* One eye: the inputs of its pictures, whether there are enough, its scene and light. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "anatomy/light.h"
#include "base/file.h"
#include "base/mem.h"
#include "draw/eye/tint.h"
#include "draw/photo/reference.h"
#include "draw/photo/vessels.h"
#include "draw/studio.h"
#include "render/render.h"

static const char *artifact(struct job *job, const char *name)
{
	// Inputs are named relative to the folder; the stage owns the string's longer form.
	return stage_path(job->stage, "%s/%s", job->names->iris, name) + strlen(job->stage->capture) + 1;
}

/* A file that a key names, if it does. */
static bool input_inside(struct job *job, const char *key, const char *rel, struct err *err)
{
	char *inside = 0;
	if (!rel)
		return true;
	if (!file_inside(&inside, job->stage->capture, rel, err))
		return err_wrap(err, "%s", key);
	free(inside);
	job->in[job->n_in++] = rel;
	return true;
}

static bool inputs(struct job *job, struct err *err)
{
	const struct shot *reference = &job->shots[job->reference];
	const char *clean = artifact(job, "clean.exr");
	bool use_clean = !job->conf->freckles && file_exists(stage_path(job->stage, "%s", clean));
	job->in[job->n_in++] = use_clean ? clean : artifact(job, "texture.exr");
	job->in[job->n_in++] = artifact(job, "texture.json");
	job->in[job->n_in++] = artifact(job, "relief.exr");
	job->in[job->n_in++] = artifact(job, "pigment.json");
	job->in[job->n_in++] = artifact(job, "refraction.exr");
	job->in[job->n_in++] = reference->photo->fit;
	job->in[job->n_in++] = reference->photo->file;
	return input_inside(job, "render.environment", job->conf->environment, err) && input_inside(job, "light.environment", job->conf->light, err);
}

static bool job_open(struct job *job, const struct capture *capture, int eye_index, struct err *err)
{
	job->names = &capture->eyes[eye_index];
	if (!shots_load(job, capture, eye_index, err))
		return false;
	if (!job->n_shots)
		return true;
	if (!inputs(job, err))
		return false;
	job->usable = file_exists(stage_path(job->stage, "%s", job->in[0]));
	return true;
}

bool jobs_open(struct jobs *jobs, struct stage *stage, const struct capture *capture, const struct eye *eye,
               const struct render_conf *conf, struct err *err)
{
	bool ok = true;
	*jobs = (struct jobs){ .job = mem_new((size_t)capture->n_eyes + 1, sizeof *jobs->job) };
	for (int i = 0; ok && i < capture->n_eyes; i++) {
		jobs->job[jobs->n] = (struct job){ .stage = stage, .conf = conf, .eye = eye };
		ok = job_open(&jobs->job[jobs->n++], capture, i, err);
	}
	return ok;
}

/* Records as skipped what is drawn in place of artifacts that are missing or unusable. */
static void say_what_lacks(struct job *job)
{
	static const char *const instead[] = { [2] = "an iris without relief is drawn", [3] = "the tissue of a blue eye is drawn" };
	const struct scene *s = &job->scene;
	for (int i = 2; i < 4; i++)
		if (!file_exists(stage_path(job->stage, "%s", job->in[i])))
			stage_skipped(job->stage, "%s of %s eye: %s is missing: %s", i == 2 ? "relief" : "pigment", job->names->side, job->in[i], instead[i]);
	char reason[256];
	if (tissue_without(reason, stage_path(job->stage, "%s", job->in[3])))
		stage_skipped(job->stage, "pigment of %s eye: %s: %s", job->names->side, reason, instead[3]);
	if (s->not_finite)
		stage_skipped(job->stage, "%ld values of the maps of the %s eye: they are no numbers: drawn as 0", s->not_finite, job->names->side);
	if (s->odd_pupil != 0)
		stage_skipped(job->stage, "pupil of the %s eye: %s says a radius of %g mm, in an iris of %.2f mm: one of %.1f mm is drawn", job->names->side,
		              job->in[1], s->odd_pupil, s->limbus[0], s->pupil[2]);
}

bool job_studio(struct job *job, struct err *err)
{
	if (!job->conf->environment) {
		job->studio = light_studio(env_height(job->conf));
		return true;
	}
	if (!light_load(&job->studio, 0, job->stage, "render.environment", job->conf->environment, err))
		return false;
	envmap_normalise(&job->studio);
	return true;
}

bool job_ready(struct job *job, struct err *err)
{
	struct shot *reference = &job->shots[job->reference];
	struct scene_conf conf = job->conf->scene;
	if (job->ready)
		return true;
	if (!shot_ready(job, reference, err) || !job_studio(job, err))
		return false;
	struct scene_white white;
	if (!scene_white(&white, stage_path(job->stage, "%s", job->in[3]), err))
		return false;
	if (white.has_sclera)
		memcpy(conf.sclera_rgb, white.sclera, sizeof conf.sclera_rgb);
	else
		stage_note(job->stage, "%s: too little of the sclera shows: a generic one", job->names->side);
	struct image vessels;
	const bool seen = vessels_of_photo(&vessels, reference, job->eye, conf.sclera_radius, conf.veins_px);
	conf.vessels = seen ? &vessels : 0;
	job->gain = studio_exposure(&job->studio, conf.sclera_rgb);
	struct eye eye = *job->eye;
	if (!isfinite(eye.limbus_aspect))
		eye.limbus_aspect = reference->fit.limbus_aspect;
	if (!isfinite(conf.limbus_width))
		conf.limbus_width = shot_limbus_width(reference);
	const char *path[5];
	for (int i = 0; i < 5; i++)
		path[i] = stage_path(job->stage, "%s", job->in[i]);
	struct scene_files files = { path[0], path[1], path[2], path[3], path[4] };
	const bool loaded = scene_load(&job->scene, &files, &eye, &conf, err);
	job->scene.conf.vessels = 0;
	if (seen)
		image_free(&vessels);
	if (!loaded)
		return false;
	say_what_lacks(job);
	job->ready = true;
	struct scene_view view = shot_view(reference);
	struct scene_lighting light = scene_lighting_of(&reference->env, 0, job->conf->lights, job->conf->light_directions);
	scene_fit_colour(&job->scene, &view, &light);
	stage_figure(job->stage, "lamps_found", reference->n_lamps, "");
	stage_figure(job->stage, "exposure", job->scene.gain, "");
	stage_figure(job->stage, "limbus_shadow", (job->scene.rim.edge - 1) * job->scene.limbus[0], "mm");
	stage_figure(job->stage, "explained_by_model", 100 * job->scene.explained, "%");
	return true;
}

static void job_close(struct job *job)
{
	if (job->ready)
		scene_free(&job->scene);
	envmap_free(&job->studio);
	shots_free(job);
}

void jobs_close(struct jobs *jobs)
{
	for (int i = 0; i < jobs->n; i++)
		job_close(&jobs->job[i]);
	free(jobs->job);
}
