#include "base/json.h"
#include "base/template.h"
#include "render/face/skin.h"

#include <stdlib.h>
#include <string.h>

bool skin_told_save(struct skin_job *job, struct skin_target *t, struct err *err)
{
	const char *path = stage_path(job->stage, "work/render/%s_skin.json", t->name), *rel = path + strlen(job->stage->capture) + 1;
	if (skin_kept(job, rel, t->n_in, t->in, err))
		return true;
	// Whether a film serves is known when it has been looked at.
	if (err_is(err) || !skin_open(job, t, err))
		return false;
	json_t *root = json_pack("{s:s,s:o}", "skin", t->told.from, "reason", template_text(t->told.why.msg));
	if (!strcmp(t->told.from, "video") || !strcmp(t->told.from, "views"))
		json_object_update_new(root, json_pack("{s:f,s:f}", "seen", t->told.seen, "mirrored", t->told.mirrored));
	if (err_is(&job->iris_told))
		json_object_set_new(root, "iris", template_text(job->iris_told.msg));
	const bool ok = json_write(path, root, stage_made_by(job->stage, t->n_in, t->in), err) && skin_made(job, rel, t->n_in, t->in, err);
	json_decref(root);
	return ok;
}
