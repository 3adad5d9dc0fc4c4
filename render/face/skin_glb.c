/* The driven character as a glTF, with whole eyes. */
#include <math.h>
#include <string.h>

#include "base/mem.h"
#include "render/face/skin.h"

/* The eyes as files in memory, once: what the pictures show on that side. */
static bool eyes_glb(struct skin_job *job, struct err *err)
{
	for (int s = 0; s < 2; s++) {
		if (job->eye_glb[s])
			continue;
		if (s && job->eyes[1] == job->eyes[0]) {
			job->eye_glb[1] = job->eye_glb[0];
			job->eye_size[1] = job->eye_size[0];
		} else if (!export_in_face(&job->eye_glb[s], &job->eye_size[s], job->eyes[s], &job->studio, job->leaves, err)) {
			return false;
		}
	}
	return true;
}

bool skin_glb(struct skin_job *job, struct skin_target *t, const char *csv, struct err *err)
{
	const char *in[COUNT(t->in) + 1], *rel = stage_path(job->stage, "work/render/%s.glb", t->name) + strlen(job->stage->capture) + 1;
	int n = t->n_in;
	struct drive drive;
	struct glb_report report;
	struct glb_conf conf = job->conf->glb;
	memcpy(in, t->in, sizeof t->in);
	in[n++] = csv;
	if (skin_kept(job, rel, n, in, err))
		return true;
	if (!skin_open(job, t, err) || !eyes_glb(job, err) || !drive_load(&drive, &job->model, stage_path(job->stage, "%s", csv), err))
		return false;
	memcpy(conf.skin_rgb, job->conf->portrait.skin_rgb, sizeof conf.skin_rgb);
	memcpy(conf.hair_rgb, job->conf->portrait.hair_rgb, sizeof conf.hair_rgb);
	conf.hairs = portrait_hairs(t->portrait);
	conf.tear_mm = job->conf->portrait.tear_mm;
	conf.expression = (const char *const *)job->model.au_names;
	conf.n_expressions = job->model.n_au;
	struct glb_eye eye[2];
	double over = -INFINITY;
	for (int s = 0; s < 2; s++) {
		eye[s] = (struct glb_eye){ job->eye_glb[s], job->eye_size[s], job->eyes[s]->conf.sclera_radius };
		over = fmax(over, skin_over_globe(job->eyes[s], &t->rig.globe[s]));
	}
	conf.over_mm = fmax(over, 0);
	bool ok = glb_write(stage_path(job->stage, "%s", rel), &report, &t->rig, &drive, eye, t->name, t->dress ? &t->look : 0, &conf,
	                    stage_made_by(job->stage, n, in), err)
	          && skin_made(job, rel, n, in, err);
	if (ok) {
		stage_note(job->stage, "%s: %d morph targets, %d vertices move, %.2f mm off at worst, eyes %.2f mm over its globes, %.1f MB", rel,
		           report.targets, report.moving, report.worst, over, (double)report.bytes / 1e6);
		stage_figure(job->stage, "morph_targets", report.targets, "");
		stage_figure(job->stage, "morph_worst", report.worst, "mm, worst vertex of all frames");
		stage_figure(job->stage, "eyes_over_globe", over, "mm, the eyes in the .glb over the globes that the lids clear");
	}
	drive_free(&drive);
	return ok;
}
