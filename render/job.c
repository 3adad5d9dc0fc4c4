/* One eye on its way to pictures: what it is made of, and whether there is enough of it. */
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "render/render.h"

static const char *artifact(struct job *job, const char *name)
{
	// Inputs are named relative to the folder; the stage owns the string's longer form.
	return stage_path(job->stage, "%s/%s", job->names->iris, name) + strlen(job->stage->capture) + 1;
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
	if (job->conf->environment) {
		char *inside = 0;
		if (!file_inside(&inside, job->stage->capture, job->conf->environment, err))
			return err_wrap(err, "render.environment");
		free(inside);
		job->in[job->n_in++] = job->conf->environment;
	}
	return true;
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

void job_say_what_lacks(struct job *job)
{
	static const char *const instead[] = { [2] = "an iris without relief is drawn", [3] = "the tissue of a blue eye is drawn" };
	const struct scene *s = &job->scene;
	for (int i = 2; i < 4; i++)
		if (!file_exists(stage_path(job->stage, "%s", job->in[i])))
			stage_skipped(job->stage, "%s of %s eye: %s is missing: %s", i == 2 ? "relief" : "pigment", job->names->side, job->in[i], instead[i]);
	if (s->not_finite)
		stage_skipped(job->stage, "%ld values of the maps of the %s eye: they are no numbers: drawn as 0", s->not_finite, job->names->side);
	if (s->odd_pupil != 0)
		stage_skipped(job->stage, "pupil of the %s eye: %s says a radius of %g mm, in an iris of %.2f mm: one of %.1f mm is drawn", job->names->side,
		              job->in[1], s->odd_pupil, s->limbus[0], s->pupil[2]);
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
