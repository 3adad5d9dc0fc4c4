#include "model/train/train.h"

#include <float.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "math/linalg.h"
#include "model/train/impl.h"

static const double farthest = 1e6;  // px: nothing in a picture is further away

void train_warn(struct train *t, const char *fmt, ...)
{
	char *line = 0;
	va_list ap;
	va_start(ap, fmt);
	if (vasprintf(&line, fmt, ap) < 0)
		line = 0;
	va_end(ap);
	struct train_report *r = t->report;
	r->warnings = mem_grow(r->warnings, (size_t)r->n_warnings + 1, sizeof *r->warnings);
	r->warnings[r->n_warnings++] = line;
}

void train_report_free(struct train_report *r)
{
	for (int p = 0; p < TRAIN_PARTS; p++) {
		free(r->curve[p].linear);
		free(r->curve[p].rbf);
		free(r->curve[p].pca);
		free(r->curve[p].random);
		free(r->curve[p].linear_sigma);
		free(r->curve[p].rbf_sigma);
	}
	for (int i = 0; i < r->n_warnings; i++)
		free(r->warnings[i]);
	free(r->warnings);
	*r = (struct train_report){ 0 };
}

static inline void keep_if_measured(double *x, double *c, double to, double belief)
{
	bool ok = fabs(to) <= farthest && belief > 0;
	*x = ok ? to : NAN;
	*c = !ok ? 0 : belief < 1 ? belief : 1;
}

/* Points that all lie in the very same place are no lids and no skin: what a tracker writes that has nothing to write. */
static bool collapsed(int n, const double *x, const double *c)
{
	double place[2] = { NAN, NAN };
	int measured = 0;
	for (int i = 0; i < n; i++) {
		if (!(c[i] > 0))
			continue;
		measured++;
		if (isnan(place[i % 2]))
			place[i % 2] = x[i];
		else if (x[i] != place[i % 2])
			return false;
	}
	return measured > 2;
}

static void forget(int n, double *x, double *c)
{
	for (int i = 0; i < n; i++) {
		x[i] = NAN;
		c[i] = 0;
	}
}

void train_accept(const struct train *t, long n, const double *lid, const double *skin, const double *seen,
                  double *const x[TRAIN_PARTS], double *const c[TRAIN_PARTS])
{
	long nu = t->part[TRAIN_SKIN].n;
	for (long r = 0; r < n; r++) {
		for (int p = 0; p < 2; p++)
			for (int i = 0; i < t->n_eye; i++)
				keep_if_measured(&x[p][r * t->n_eye + i], &c[p][r * t->n_eye + i], lid[r * t->n_lid + p * t->n_eye + i], 1);
		double *to = x[TRAIN_SKIN] + r * nu, *belief = c[TRAIN_SKIN] + r * nu;
		for (long i = 0; i < nu; i++)
			keep_if_measured(&to[i], &belief[i], skin[r * nu + i], seen[r * nu / 2 + i / 2]);
		for (int p = 0; p < TRAIN_PARTS; p++) {
			long at = r * t->part[p].n;
			if (collapsed(t->part[p].n, x[p] + at, c[p] + at))
				forget(t->part[p].n, x[p] + at, c[p] + at);
		}
	}
}

bool train_read(struct train *t, long first, long n, double *const x[TRAIN_PARTS], double *const c[TRAIN_PARTS],
                struct err *err)
{
	size_t nu = (size_t)t->part[TRAIN_SKIN].n;
	double *lid = mem_array((size_t)n * (size_t)t->n_lid + 1, sizeof *lid), *skin = mem_array((size_t)n * nu + 1, sizeof *skin);
	double *seen = mem_array((size_t)n * nu / 2 + 1, sizeof *seen);
	bool ok = t->clip->read(t->clip->ctx, first, n, lid, skin, seen, err);
	if (ok)
		train_accept(t, n, lid, skin, seen, x, c);
	free(lid);
	free(skin);
	free(seen);
	return ok;
}

static bool check(const struct train_clip *clip, const struct train_conf *conf, struct err *err)
{
	double p = SKIN_LIDS * clip->n_points * 2 + clip->n_au + 2.0 * clip->n_vertices, sample = fmin(conf->sample, (double)clip->n);
	double mib = (p * p * (clip->n > PILOT_FRAMES ? 2 : 1) + p * (sample + 4 * PILOT_FRAMES + 6 * SCATTER_BLOCK)) * 8 / 1048576;
	int most = conf->lid_components > conf->skin_components ? conf->lid_components : conf->skin_components;
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
