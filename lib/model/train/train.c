#include "model/train/train.h"

#include <math.h>
#include <stdlib.h>

#include "base/mem.h"
#include "math/linalg.h"
#include "model/train/impl.h"

/* Whether the clip is long enough and fits into the memory allowed. */
static bool check(const struct train_clip *clip, const struct train_conf *conf, struct err *err)
{
	double p = SKIN_LIDS * clip->n_points * 2 + clip->n_au + 2.0 * clip->n_vertices, sample = fmin(conf->sample, (double)clip->n);
	double mib = (p * p * (clip->n > PILOT_FRAMES ? 2 : 1) + p * (sample + 4 * PILOT_FRAMES + 6 * SCATTER_BLOCK)) * 8 / 1048576;
	int most = conf->lid_components > conf->skin_components || !clip->n_vertices ? conf->lid_components : conf->skin_components;
	if (clip->n <= most)
		return err_set(err, "%s: %ld frames, must be more than the %d components of the model: film longer", clip->place,
		               clip->n, most);
	if (mib > conf->memory_mb)
		return err_set(err, "%s: %d skin points need %.0f MiB: follow fewer points, or raise train.memory_mb = %d", clip->place,
		               clip->n_vertices, mib, conf->memory_mb);
	return true;
}

static bool enough_frames(struct train *t, struct err *err)
{
	static const char *const what[TRAIN_PARTS] = { "the left eye's lids", "the right eye's lids", "the skin" };
	for (int p = 0; p < TRAIN_PARTS; p++) {
		int k = t->part[p].kept;
		if (t->part[p].used && t->part[p].sum.n <= k)
			return err_set(err, "%s: %ld frames show %s, must be more than the %d components of the model: film longer",
			               t->clip->place, t->part[p].sum.n, what[p], k);
	}
	return true;
}

/* Sizes of the model and of its parts. */
static void set_up(struct train *t)
{
	const struct train_clip *clip = t->clip;
	struct skin_model *m = t->model;
	int n_eye = SKIN_LIDS * clip->n_points, n_skin = 2 * clip->n_vertices;
	int lid_pc = t->conf->lid_components < n_eye ? t->conf->lid_components : n_eye;
	int skin_pc = t->conf->skin_components < n_skin ? t->conf->skin_components : n_skin;
	*m = (struct skin_model){ .n_au = clip->n_au, .n_points = clip->n_points, .n_vertices = clip->n_vertices,
		                      .n_lid_pc = 2 * lid_pc, .n_skin_pc = skin_pc };
	skin_model_alloc(m);
	t->n_lid = m->n_lid;
	t->n_eye = m->n_lid / 2;
	t->eye[0] = t->eye[1] = true;
	for (int p = 0; p < TRAIN_PARTS; p++) {
		t->part[p].n = p == TRAIN_SKIN ? n_skin : t->n_eye;
		t->part[p].kept = p == TRAIN_SKIN ? skin_pc : lid_pc;
	}
}

bool train_run(struct skin_model *model, struct train_report *report, const struct train_clip *clip,
               const struct train_conf *conf, struct err *err)
{
	struct train t = { .clip = clip, .conf = conf, .model = model, .report = report };
	*report = (struct train_report){ 0 };
	*model = (struct skin_model){ 0 };
	if (!check(clip, conf, err))
		return false;
	int threads = linalg_serial();
	set_up(&t);
	bool ok = train_inputs(&t, err) && train_sample(&t, err) && train_stream(&t, err) && enough_frames(&t, err);
	if (ok) {
		train_apertures(&t);
		train_expressions(&t);
		train_fit(&t);
		train_sigmas(&t);
		train_reach(&t);
	}
	for (int p = 0; p < TRAIN_PARTS; p++)
		part_free(&t.part[p]);
	scatter_free(&t.inputs);
	free(t.g);
	free(t.sample);
	free(t.block);
	linalg_threads(threads);
	return ok;
}
