/* One eye on its way to pictures: what it is made of, and whether there is enough of it. */
#include <stdlib.h>
#include <string.h>

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

bool job_open(struct job *job, bool *usable, struct stage *stage, const struct capture *capture, int eye_index,
              const struct eye *eye, const struct render_conf *conf, struct err *err)
{
	*job = (struct job){ .stage = stage, .conf = conf, .eye = eye, .names = &capture->eyes[eye_index] };
	*usable = false;
	if (!shots_load(job, capture, eye_index, err))
		return false;
	if (!job->n_shots)
		return true;
	if (!inputs(job, err))
		return false;
	*usable = file_exists(stage_path(stage, "%s", job->in[0]));
	return true;
}

void job_close(struct job *job)
{
	if (job->ready)
		scene_free(&job->scene);
	envmap_free(&job->studio);
	shots_free(job);
}
