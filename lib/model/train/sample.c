/* Draws the sample, estimates the pilots, and weighs frames. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "model/train/impl.h"

struct frames frames_new(const struct train *t, long n)
{
	struct frames f;
	for (int p = 0; p < TRAIN_PARTS; p++) {
		size_t all = (size_t)n * (size_t)t->part[p].n + 1;
		f.x[p] = mem_array(all, sizeof(double));
		f.c[p] = mem_array(all, sizeof(double));
		f.d[p] = mem_array((size_t)n + 1, sizeof(double));
		f.share[p] = mem_array((size_t)n + 1, sizeof(double));
		f.w[p] = mem_array((size_t)n + 1, sizeof(double));
	}
	return f;
}

void frames_free(struct frames *f)
{
	for (int p = 0; p < TRAIN_PARTS; p++) {
		free(f->x[p]);
		free(f->c[p]);
		free(f->d[p]);
		free(f->share[p]);
		free(f->w[p]);
	}
}

/* Decides which parts are modelled: those of which most coordinates were measured often enough (of the skin, any). */
static void set_used(struct train *t)
{
	for (int p = 0; p < TRAIN_PARTS; p++) {
		struct part *part = &t->part[p];
		int seen = 0;
		for (int i = 0; i < part->n; i++)
			seen += part->seen[i];
		part->used = seen > 0.5 * part->n || (p == TRAIN_SKIN && seen > 0);
		if (p != TRAIN_SKIN) {
			part->used = part->used && t->eye[p];
			t->eye[p] = part->used;
		}
	}
}

void train_weigh(const struct train *t, struct frames *f, long n, const long *frame)
{
	for (long i = 0; i < n; i++) {
		const double *g = t->g + frame[i] * t->model->n_inputs;
		bool lids = true;
		for (int p = 0; p < 2; p++) {
			double trust = t->clip->confidence[2 * frame[i] + p];
			bool known = f->share[p][i] >= TRAIN_LEAST_SHARE;
			for (int k = 0; k < EYE_INPUTS; k++)
				known = known && !isnan(g[EYE_INPUTS * p + k]);
			// The gaze of a closed eye is not measured and has no confidence, but the blink is learnt from its lids.
			trust = isnan(trust) || isnan(t->clip->g[frame[i] * t->model->n_inputs + EYE_INPUTS * p]) ? 1 : fmax(0, fmin(trust, 1));
			f->w[p][i] = t->part[p].used && known ? trust * part_weight(&t->part[p], t->conf, f->d[p][i]) : 0;
			lids = lids && (!t->part[p].used || f->share[p][i] >= TRAIN_LEAST_SHARE);
		}
		bool seen = lids && f->share[TRAIN_SKIN][i] >= TRAIN_LEAST_SHARE;
		f->w[TRAIN_SKIN][i] = seen ? part_weight(&t->part[TRAIN_SKIN], t->conf, f->d[TRAIN_SKIN][i]) : 0;
	}
}

/* Divides the sample into time blocks of conf->block_s; of a short clip, into four for every fold, of at least four frames each. The
 * first guard_s of each block belong to none (-1). */
static void set_blocks(struct train *t)
{
	const double *time = t->clip->time;
	double span = time[t->clip->n - 1] - time[0], length = fmin(t->conf->block_s, span / (4 * t->conf->folds));
	length = fmax(length, 4 * span / (double)t->clip->n);
	for (long i = 0; i < t->n_sample; i++) {
		double at = time[t->sample[i]] - time[0];
		int block = length > 0 ? (int)(at / length) : (int)(i * 4 * t->conf->folds / t->n_sample);
		bool gap = length > 0 && block > 0 && at - block * length < fmin(t->conf->guard_s, length / 3);
		t->block[i] = gap ? -1 : block;
		t->n_blocks = block + 1;
	}
}

/* Reads the sample's frame i into row `at` of f. */
static bool read_into(struct frames *f, long at, struct train *t, long i, struct err *err)
{
	double *x[TRAIN_PARTS], *c[TRAIN_PARTS];
	for (int p = 0; p < TRAIN_PARTS; p++) {
		x[p] = f->x[p] + at * t->part[p].n;
		c[p] = f->c[p] + at * t->part[p].n;
	}
	return train_read(t, t->sample[i], 1, x, c, err);
}

/* Estimates the pilots from at most PILOT_FRAMES of the sample's frames. */
static bool pilots(struct train *t, struct err *err)
{
	long step = (t->n_sample + PILOT_FRAMES - 1) / PILOT_FRAMES, m = 0;
	struct frames f = frames_new(t, t->n_sample / step + 1);
	bool ok = true;
	for (long i = 0; i < t->n_sample && ok; i += step, m++)
		ok = read_into(&f, m, t, i, err);
	for (int p = 0; p < TRAIN_PARTS && ok; p++)
		part_pilot(&t->part[p], m, f.x[p], f.c[p], t->conf);
	frames_free(&f);
	return ok;
}

bool train_sample(struct train *t, struct err *err)
{
	t->n_sample = t->clip->n < t->conf->sample ? t->clip->n : t->conf->sample;
	t->sample = mem_new((size_t)t->n_sample + 1, sizeof *t->sample);
	t->block = mem_new((size_t)t->n_sample + 1, sizeof *t->block);
	for (long i = 0; i < t->n_sample; i++)
		t->sample[i] = (long)((double)i * (double)t->clip->n / (double)t->n_sample);
	set_blocks(t);
	if (!pilots(t, err))
		return false;
	set_used(t);
	if (!t->eye[0] && !t->eye[1])
		return err_set(err, "%s: the lids of neither eye are measured in enough frames (train.min_seen = %g): film an open eye, close and sharp",
		               t->clip->place, t->conf->min_seen);
	if (!t->part[TRAIN_SKIN].used && t->clip->n_vertices)
		return err_set(err, "%s: no skin point is seen in enough frames (train.min_seen = %g): film closer, in even light",
		               t->clip->place, t->conf->min_seen);
	struct frames f = frames_new(t, t->n_sample);
	bool ok = true;
	for (long i = 0; i < t->n_sample && ok; i++)
		ok = read_into(&f, i, t, i, err);
	for (int p = 0; p < TRAIN_PARTS && ok; p++)
		part_complete(&t->part[p], t->n_sample, f.x[p], f.c[p], f.d[p], f.share[p]);
	if (ok)
		train_weigh(t, &f, t->n_sample, t->sample);
	for (int p = 0; p < TRAIN_PARTS; p++) {
		t->part[p].x = f.x[p];
		t->part[p].w = f.w[p];
		f.x[p] = f.w[p] = 0;
	}
	frames_free(&f);
	return ok;
}

