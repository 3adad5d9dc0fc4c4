#include "stages/track/wrinkles.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "image/exr.h"
#include "stages/track/wrinkle_sheet.h"

const char *const wrinkle_files[WRINKLE_FILES] = { "work/skin/wrinkles.json", "work/skin/wrinkles.exr", "work/skin/wrinkles.png" };

bool wrinkles_wanted(const struct track_conf *conf, bool has_mesh)
{
	return conf->expression.n && has_mesh;
}

static bool save_bumps(struct stage *stage, const struct wrinkles *w, int n, const char *const in[], struct err *err)
{
	struct image all = image_new(w->width, w->height, 2 * w->n);
	char **name = mem_new(2 * (size_t)w->n + 1, sizeof *name);
	for (int i = 0; i < w->n; i++) {
		struct image one = wrinkle_bump(w, &w->pose[i]);
		for (long k = 0; k < (long)w->width * w->height; k++)
			memcpy(all.px + 2 * (k * w->n + i), one.px + 2 * k, 2 * sizeof *one.px);
		name[2 * i] = mem_printf("%s.height", w->pose[i].name);
		name[2 * i + 1] = mem_printf("%s.open", w->pose[i].name);
		image_free(&one);
	}
	struct exr_info info = { .made_by = stage_made_by(stage, n, in) };
	bool ok = exr_write(stage_path(stage, "%s", wrinkle_files[1]), &all, (const char *const *)name, EXR_HALF, &info, err);
	for (int i = 0; i < 2 * w->n; i++)
		free(name[i]);
	free(name);
	image_free(&all);
	return ok;
}

static void tell(struct stage *stage, const struct wrinkles *w)
{
	int lines = 0;
	double deepest = 0;
	for (int i = 0; i < w->n; i++) {
		const struct wrinkle_pose *p = &w->pose[i];
		double most = 0, length = 0;
		for (int k = 0; k < p->n; k++) {
			length += p->line[k].length;
			for (int j = 0; j < p->line[k].n; j++)
				most = fmax(most, p->line[k].point[j].depth);
		}
		lines += p->n;
		deepest = fmax(deepest, most);
		if (p->n)
			stage_note(stage, "expression.%s: %d wrinkle lines, %.0f mm in all, up to %.2f mm deep", p->name, p->n, length, most);
		else if (p->n_frames)
			stage_note(stage, "expression.%s: the skin folds into no line that its neutral frame does not have", p->name);
	}
	stage_figure(stage, "wrinkle_lines", lines, "");
	stage_figure(stage, "wrinkle_deepest", deepest, "mm");
}

/* Without expressions or points: removes what an earlier run has left. */
static bool none(struct stage *stage, bool any, struct err *err)
{
	stage_skipped(stage, "wrinkles: %s", any ? "no mesh of the person to find their depth on" : "capture.conf marks no expression: set expression.NAME to its neutral and peak frame");
	for (int i = 0; i < WRINKLE_FILES; i++)
		if (file_exists(stage_path(stage, "%s", wrinkle_files[i])) && !file_remove(stage_path(stage, "%s", wrinkle_files[i]), err))
			return false;
	return true;
}

bool wrinkles_finish(struct stage *stage, const struct track_result *r, const struct track_clip *clip, const struct track_subject *s,
                     const struct track_points *points, const struct track_conf *conf, int n, const char *const in[], struct err *err)
{
	struct folds_found found = { 0 };
	if (!r->folds)
		return none(stage, conf->expression.n, err);
	bool ok = folds_find(&found, r->folds, stage, r, clip, s, points, conf, err)
	          && wrinkles_save(&found.wrinkles, stage_path(stage, "%s", wrinkle_files[0]), stage_made_by(stage, n, in), err)
	          && save_bumps(stage, &found.wrinkles, n, in, err)
	          && wrinkle_sheet(stage_path(stage, "%s", wrinkle_files[2]), &found.wrinkles, &found.ground, conf->expression.n, found.neutral, found.peak, err);
	for (int i = 0; i < WRINKLE_FILES && ok; i++)
		ok = stage_made(stage, wrinkle_files[i], n, in, err);
	if (ok)
		tell(stage, &found.wrinkles);
	folds_found_free(&found);
	return ok;
}
