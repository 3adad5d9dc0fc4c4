#include "render/face/skin.h"

#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "character/import.h"

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
	const char *look = stage_path(job->stage, "work/targets/%s/look.npz", t->name);
	if (file_exists(look))
		t->in[t->n_in++] = t->look_path = look + strlen(job->stage->capture) + 1;
	if (job->render->environment)
		t->in[t->n_in++] = job->render->environment;
}

/* Says where a fitted eye is scaled by much: once a run, whichever pictures are fresh. */
static bool check_sockets(struct skin_job *job, const struct skin_target *t, struct err *err)
{
	double radius[2];
	bool fitted = false;
	for (int i = 0; i < job->photographed->n; i++)
		fitted = fitted || job->photographed->job[i].usable;
	if (!fitted)
		return true;
	if (!rig_sockets(radius, stage_path(job->stage, "%s", t->rig_path), err))
		return false;
	char *says = skin_socket_says(t->name, radius, job->render);
	if (says)
		stage_warn(job->stage, "%s", says);
	free(says);
	return true;
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
		skin_film(&t, job->stage, job->conf);
		skin_iris(&t, job);
		ok = check_sockets(job, &t, err) && skin_pictures(job, &t, err) && skin_clips(job, &t, err) && skin_told_save(job, &t, err);
		ok = ok || err_wrap(err, "targets/%s", file);
	} else {
		stage_skipped(job->stage, "pictures of targets/%s: it has no rig", file);
	}
	skin_film_keep(job, &t);
	skin_free(&t);
	free(name);
	return ok;
}

bool render_skin(struct skin_job *job, struct err *err)
{
	struct file_list targets;
	bool ok = stage_list(job->stage, &targets, "targets", err);
	if (ok && targets.n && file_exists(stage_path(job->stage, "work/skin/model.json"))) {
		job->video = first_video(job->stage, err);
		for (int i = 0; i < targets.n && ok; i++)
			ok = character_kind_of(targets.names[i]) == CHARACTER_NONE || one(job, targets.names[i], err);
	}
	file_list_free(&targets);
	return ok && !err_is(err);
}
