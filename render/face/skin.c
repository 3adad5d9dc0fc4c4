#include "render/face/skin.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "math/vec.h"

/* The room of the beauty views, exposed for skin: a face in it comes out as in a portrait. */
static const double exposure = 0.95;

static const char *first_video(struct stage *stage, struct err *err)
{
	static const char *const kinds[] = { ".mp4", ".mov", ".mkv", ".avi", ".webm", ".m4v" };
	struct file_list list;
	const char *found = 0;
	if (!stage_list(stage, &list, "video", err))
		return 0;
	for (int i = 0; i < list.n && !found; i++)
		for (int k = 0; k < COUNT(kinds) && !found; k++) {
			const char *dot = strrchr(list.names[i], '.');
			if (dot && !strcasecmp(dot, kinds[k]))
				found = stage_path(stage, "video/%s", list.names[i]) + strlen(stage->capture) + 1;
		}
	file_list_free(&list);
	return found;
}

static bool light_ready(struct skin_job *job, struct err *err)
{
	struct job studio = { .stage = job->stage, .conf = job->render };
	bool ok = job_studio(&studio, err);
	job->studio = studio.studio;
	job->gain = exposure;
	return ok;
}

/* A fitted eye on its own side; the only one, or the unnamed one, on both. */
static bool eyes_ready(struct skin_job *job, struct err *err)
{
	for (int i = 0, n = 0; i < job->photographed->n && n < 2; i++) {
		struct job *eye = &job->photographed->job[i];
		if (!eye->usable)
			continue;
		n++;
		if (!job_ready(eye, err))
			return false;
		int side = !strcmp(eye->names->side, "right");
		job->eyes[side] = &eye->scene;
		if (!job->eyes[!side])
			job->eyes[!side] = &eye->scene;
	}
	if (job->eyes[0])
		return true;
	struct eye eye = *job->eye;
	struct scene_conf conf = job->render->scene;
	eye.limbus_aspect = isfinite(eye.limbus_aspect) ? eye.limbus_aspect : 0.95;
	conf.limbus_width = isfinite(conf.limbus_width) ? conf.limbus_width : 0.5;
	scene_plain(&job->plain, &eye, &conf, job->conf->glb.iris_rgb, (uint64_t)conf.seed);
	struct scene_view view = scene_view_turned(&job->plain, 0, 0, job->render->field_mm, 256);
	struct scene_lighting light = scene_lighting(&job->studio, 0, job->render->lights);
	scene_fit_colour(&job->plain, &view, &light);
	job->eyes[0] = job->eyes[1] = &job->plain;
	return true;
}

bool skin_ready(struct skin_job *job, struct err *err)
{
	job->ready = job->ready || (light_ready(job, err) && eyes_ready(job, err)
	                            && skin_model_load(&job->model, stage_path(job->stage, "work/skin"), err)
	                            && wrinkle_maps_load(&job->wrinkles, stage_path(job->stage, "work/skin"), err));
	return job->ready;
}

bool skin_open(struct skin_job *job, struct skin_target *t, struct err *err)
{
	if (t->portrait)
		return true;
	if (!skin_ready(job, err) || !rig_load(&t->rig, stage_path(job->stage, "%s", t->rig_path), err))
		return false;
	if (t->rig.n_inputs != job->model.n_inputs)
		return err_set(err, "%s: %d inputs, but work/skin/model.json has %d: run extrapolate again", t->rig_path, t->rig.n_inputs,
		               job->model.n_inputs);
	t->portrait = portrait_new(&t->rig, job->eyes, &job->studio, &job->conf->portrait);
	portrait_wear(t->portrait, &job->wrinkles, job->model.n_au, job->model.au_names);
	return true;
}

static void inputs(struct skin_job *job, struct skin_target *t)
{
	t->in[t->n_in++] = t->rig_path;
	t->in[t->n_in++] = "work/skin/model.json";
	static const char *const folds[] = { "work/skin/wrinkles.json", "work/skin/wrinkles.exr" };
	for (int i = 0; i < COUNT(folds); i++)
		if (file_exists(stage_path(job->stage, "%s", folds[i])))
			t->in[t->n_in++] = folds[i];
	for (int i = 0; i < job->capture->n_eyes && i < 2; i++) {
		static const char *const maps[] = { "texture.exr", "clean.exr", "relief.exr", "pigment.json" };
		for (int k = 0; k < COUNT(maps); k++) {
			const char *path = stage_path(job->stage, "%s/%s", job->capture->eyes[i].iris, maps[k]);
			t->in[t->n_in++] = path + strlen(job->stage->capture) + 1;
		}
	}
	if (job->render->environment)
		t->in[t->n_in++] = job->render->environment;
}

static bool one(struct skin_job *job, const char *file, struct err *err)
{
	const char *dot = strrchr(file, '.');
	char *name = mem_printf("%.*s", dot ? (int)(dot - file) : (int)strlen(file), file);
	struct skin_target t = { .name = name };
	t.rig_path = stage_path(job->stage, "work/targets/%s/rig.npz", name) + strlen(job->stage->capture) + 1;
	bool ok = true;
	if (file_exists(stage_path(job->stage, "%s", t.rig_path))) {
		inputs(job, &t);
		ok = skin_pictures(job, &t, err) && skin_clips(job, &t, err);
		ok = ok || err_wrap(err, "targets/%s", file);
	} else {
		stage_skipped(job->stage, "pictures of targets/%s: it has no rig", file);
	}
	portrait_free(t.portrait);
	rig_free(&t.rig);
	free(name);
	return ok;
}

void skin_close(struct skin_job *job)
{
	if (job->eyes[0] == &job->plain)
		scene_free(&job->plain);
	envmap_free(&job->studio);
	skin_model_free(&job->model);
	wrinkle_maps_free(&job->wrinkles);
}

bool render_skin(struct skin_job *job, struct err *err)
{
	struct file_list targets;
	bool ok = stage_list(job->stage, &targets, "targets", err);
	if (ok && targets.n && file_exists(stage_path(job->stage, "work/skin/model.json"))) {
		job->video = first_video(job->stage, err);
		for (int i = 0; i < targets.n && ok; i++)
			ok = one(job, targets.names[i], err);
	}
	file_list_free(&targets);
	return ok && !err_is(err);
}
