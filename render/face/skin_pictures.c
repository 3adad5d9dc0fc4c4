/* Stills of a driven character. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "draw/studio.h"
#include "image/exr.h"
#include "image/picture.h"
#include "math/vec.h"
#include "render/face/skin.h"

static const char *output(struct skin_job *job, const char *name, const char *suffix)
{
	return stage_path(job->stage, "work/render/%s%s", name, suffix) + strlen(job->stage->capture) + 1;
}

static double eye_distance(const struct rig *rig)
{
	double d[3];
	vec_add(d, rig->globe[0].center, -1, rig->globe[1].center);
	return vec_norm(d);
}

/* One picture on grey. h, v: gaze, degrees; au: expression shown in full, -1: none; side < 0: both eyes; layers: out, or null. image_free
 * both. */
static struct image look_with(struct skin_job *job, struct skin_target *t, double h, double v, double aperture, int au, int side, double field,
                              int width, int height, struct image *layers)
{
	double *controls = mem_new((size_t)t->rig.n_inputs + 1, sizeof *controls);
	drive_look(controls, &t->rig, h, v, aperture);
	if (au >= 0)
		drive_express(controls, &t->rig, au, 1, aperture);
	portrait_pose(t->portrait, controls);
	struct portrait_view view = portrait_front(&t->rig, side, field, 0, 0, width, height);
	portrait_light(t->portrait, &view, true);
	struct image rgba = portrait_draw(t->portrait, &view), seen = studio_on_grey(&rgba, job->gain, &job->render->finish);
	if (layers)
		*layers = portrait_layers(t->portrait, &view, &rgba);
	image_free(&rgba);
	free(controls);
	return seen;
}

static struct image look(struct skin_job *job, struct skin_target *t, double h, double v, double aperture, int side, double field,
                         int width, int height, struct image *layers)
{
	return look_with(job, t, h, v, aperture, -1, side, field, width, height, layers);
}

static bool save(struct skin_job *job, struct skin_target *t, const char *rel, const struct image *image, struct err *err)
{
	return picture_png_write_linear(stage_path(job->stage, "%s", rel), image, err)
	       && skin_made(job, rel, t->n_in, t->in, err);
}

static void put(struct image *sheet, const struct image *cell, int x, int y)
{
	for (int row = 0; row < cell->height; row++)
		memcpy(image_at(sheet, x, y + row), image_at(cell, 0, row), (size_t)cell->width * 3 * sizeof(float));
}

static bool layers_write(struct skin_job *job, struct skin_target *t, const char *rel, const struct image *layers, struct err *err)
{
	static const char *const names[PORTRAIT_LAYERS] = { "Z", "distance", "lake", "N.X", "N.Y", "N.Z", "diffuse.R", "diffuse.G", "diffuse.B",
		                                                "specular.R", "specular.G", "specular.B" };
	struct exr_info info = { .made_by = stage_made_by(job->stage, t->n_in, t->in) };
	return exr_write(stage_path(job->stage, "%s", rel), layers, names, EXR_FLOAT, &info, err)
	       && stage_made(job->stage, rel, t->n_in, t->in, err);
}

static bool still(struct skin_job *job, struct skin_target *t, struct err *err)
{
	const struct skin_conf *c = job->conf;
	const char *rel = output(job, t->name, "_look.png"), *layers_rel = output(job, t->name, "_look_layers.exr");
	bool fresh = stage_fresh(job->stage, rel, t->n_in, t->in), exr = job->render->exr;
	if (fresh && (!exr || stage_fresh(job->stage, layers_rel, t->n_in, t->in)))
		return true;
	if (!skin_open(job, t, err))
		return false;
	struct image layers = { 0 };
	struct image image = look(job, t, c->gaze[0], c->gaze[1], c->aperture, -1, c->field * eye_distance(&t->rig), c->look_px,
	                          c->look_px * 9 / 16, exr ? &layers : 0);
	bool ok = save(job, t, rel, &image, err) && (!exr || layers_write(job, t, layers_rel, &layers, err));
	image_free(&layers);
	image_free(&image);
	return ok;
}

/* 3 x 3 gazes, laid out as the character looks: its left is the picture's right. */
static bool sheet(struct skin_job *job, struct skin_target *t, struct err *err)
{
	enum { GAP = 4 };
	const struct skin_conf *c = job->conf;
	const char *rel = output(job, t->name, "_sheet.png");
	int w = c->cell_px, h = w * 3 / 7;
	if (skin_kept(job, rel, t->n_in, t->in, err))
		return true;
	if (!skin_open(job, t, err))
		return false;
	struct image image = image_new(3 * w + 2 * GAP, 3 * h + 2 * GAP, 3);
	for (int k = 0; k < 9; k++) {
		int column = k % 3, row = k / 3;
		struct image cell = look(job, t, (column - 1) * c->sheet_deg[0], (1 - row) * c->sheet_deg[1], 1, -1,
		                         0.86 * c->field * eye_distance(&t->rig), w, h, 0);
		put(&image, &cell, column * (w + GAP), row * (h + GAP));
		image_free(&cell);
		stage_progress(job->stage, k + 1, 9, "gaze sheet");
	}
	bool ok = save(job, t, rel, &image, err);
	image_free(&image);
	return ok;
}

/* A blink of the left eye: quick to close, slower to open. */
static bool blink(struct skin_job *job, struct skin_target *t, struct err *err)
{
	enum { GAP = 4 };
	const struct skin_conf *c = job->conf;
	const char *rel = output(job, t->name, "_blink.png");
	int n = c->blink_frames, w = c->cell_px * 3 / 4, h = w * 3 / 4, shut = (n - 1) * 2 / 5;
	if (skin_kept(job, rel, t->n_in, t->in, err))
		return true;
	if (!skin_open(job, t, err))
		return false;
	struct image image = image_new(n * w + (n - 1) * GAP, h, 3);
	for (int k = 0; k < n; k++) {
		double phase = k <= shut ? (double)k / fmax(shut, 1) : 1 - (double)(k - shut) / fmax(n - 1 - shut, 1);
		double open = 0.5 * (1 + cos(M_PI * phase));
		struct image cell = look(job, t, 0, 0, open, 0, 0.78 * eye_distance(&t->rig), w, h, 0);
		put(&image, &cell, k * (w + GAP), 0);
		image_free(&cell);
	}
	bool ok = save(job, t, rel, &image, err);
	image_free(&image);
	return ok;
}

/* At rest, and each expression in full with its wrinkles; three beside each other, as in the gaze sheet, but higher: foreheads fold above raised brows. */
static bool expressions(struct skin_job *job, struct skin_target *t, struct err *err)
{
	enum { GAP = 4, MOST = 8, ACROSS = 3 };
	const char *rel = output(job, t->name, "_expressions.png");
	int w = job->conf->cell_px, h = w * 3 / 5;
	if (!file_exists(stage_path(job->stage, "work/skin/wrinkles.json")) || skin_kept(job, rel, t->n_in, t->in, err))
		return !err_is(err);
	if (!skin_open(job, t, err))
		return false;
	int n = job->model.n_au < MOST ? job->model.n_au + 1 : MOST + 1, across = n < ACROSS ? n : ACROSS, rows = (n + ACROSS - 1) / ACROSS;
	struct image image = image_new(across * w + (across - 1) * GAP, rows * h + (rows - 1) * GAP, 3);
	for (int k = 0; k < n; k++) {
		struct image cell = look_with(job, t, 0, 0, 1, k - 1, -1, 0.86 * job->conf->field * eye_distance(&t->rig), w, h, 0);
		put(&image, &cell, k % ACROSS * (w + GAP), k / ACROSS * (h + GAP));
		image_free(&cell);
	}
	bool ok = save(job, t, rel, &image, err);
	image_free(&image);
	return ok;
}

bool skin_pictures(struct skin_job *job, struct skin_target *t, struct err *err)
{
	return still(job, t, err) && sheet(job, t, err) && blink(job, t, err) && expressions(job, t, err);
}
