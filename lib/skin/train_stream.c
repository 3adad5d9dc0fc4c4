/* The bounded sample of frames, and the pass over all of them. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "skin/train_impl.h"

enum { LONG_CLIP = 8192 };  // frames from which on speed counts

static const double least_share = 0.3;  // of a frame's numbers must be measured for it to count

/* Buffers of `n` frames for every part: numbers, how far to believe them, distances, shares measured. */
struct frames {
	double *x[TRAIN_PARTS], *c[TRAIN_PARTS], *d[TRAIN_PARTS], *share[TRAIN_PARTS], *w[TRAIN_PARTS];
};

static struct frames frames_new(const struct train *t, long n)
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

static void frames_free(struct frames *f)
{
	for (int p = 0; p < TRAIN_PARTS; p++) {
		free(f->x[p]);
		free(f->c[p]);
		free(f->d[p]);
		free(f->share[p]);
		free(f->w[p]);
	}
}

/* How much of the part the frames show: a part hardly ever seen is not modelled. */
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

/* Fills in the frames from..from+n and weighs them. frame[i]: number of the i-th in the clip. */
static void complete(struct train *t, struct frames *f, long n, const long *frame)
{
	for (int p = 0; p < TRAIN_PARTS; p++)
		part_complete(&t->part[p], n, f->x[p], f->c[p], f->d[p], f->share[p]);
	for (long i = 0; i < n; i++) {
		const double *g = t->g + frame[i] * t->model->n_inputs;
		bool lids = true;
		for (int p = 0; p < 2; p++) {
			double trust = t->clip->confidence[2 * frame[i] + p];
			bool known = f->share[p][i] >= least_share;
			for (int k = 0; k < EYE_INPUTS; k++)
				known = known && !isnan(g[EYE_INPUTS * p + k]);
			// A closed eye has no gaze of its own to be confident of, but its lids are what a blink is learnt from.
			trust = isnan(trust) || isnan(t->clip->g[frame[i] * t->model->n_inputs + EYE_INPUTS * p]) ? 1 : fmax(0, fmin(trust, 1));
			f->w[p][i] = t->part[p].used && known ? trust * part_weight(&t->part[p], t->conf, f->d[p][i]) : 0;
			lids = lids && (!t->part[p].used || f->share[p][i] >= least_share);
		}
		bool seen = lids && f->share[TRAIN_SKIN][i] >= least_share;
		f->w[TRAIN_SKIN][i] = seen ? part_weight(&t->part[TRAIN_SKIN], t->conf, f->d[TRAIN_SKIN][i]) : 0;
	}
}

/* Time blocks of conf->block_s, but at least four for every fold; the first guard_s of each belong to none. */
static void set_blocks(struct train *t)
{
	const double *time = t->clip->time;
	double span = time[t->clip->n - 1] - time[0], length = fmin(t->conf->block_s, span / (4 * t->conf->folds));
	for (long i = 0; i < t->n_sample; i++) {
		double at = time[t->sample[i]] - time[0];
		int block = length > 0 ? (int)(at / length) : (int)(i * 4 * t->conf->folds / t->n_sample);
		bool gap = length > 0 && block > 0 && at - block * length < fmin(t->conf->guard_s, length / 3);
		t->block[i] = gap ? -1 : block;
		t->n_blocks = block + 1;
	}
}

/* The pilots from every few of the sample's frames. */
static bool pilots(struct train *t, struct err *err)
{
	long step = (t->n_sample + PILOT_FRAMES - 1) / PILOT_FRAMES, m = 0;
	struct frames f = frames_new(t, t->n_sample / step + 1);
	bool ok = true;
	for (long i = 0; i < t->n_sample && ok; i += step, m++) {
		double *x[TRAIN_PARTS], *c[TRAIN_PARTS];
		for (int p = 0; p < TRAIN_PARTS; p++) {
			x[p] = f.x[p] + m * t->part[p].n;
			c[p] = f.c[p] + m * t->part[p].n;
		}
		ok = train_read(t, t->sample[i], 1, x, c, err);
	}
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
	if (!t->part[TRAIN_SKIN].used)
		return err_set(err, "%s: no skin point is seen in enough frames (train.min_seen = %g): film closer, in even light",
		               t->clip->place, t->conf->min_seen);
	struct frames f = frames_new(t, t->n_sample);
	bool ok = true;
	for (long i = 0; i < t->n_sample && ok; i++) {
		double *x[TRAIN_PARTS], *c[TRAIN_PARTS];
		for (int p = 0; p < TRAIN_PARTS; p++) {
			x[p] = f.x[p] + i * t->part[p].n;
			c[p] = f.c[p] + i * t->part[p].n;
		}
		ok = train_read(t, t->sample[i], 1, x, c, err);
	}
	if (ok)
		complete(t, &f, t->n_sample, t->sample);
	for (int p = 0; p < TRAIN_PARTS; p++) {
		t->part[p].x = f.x[p];
		t->part[p].w = f.w[p];
		f.x[p] = f.w[p] = 0;
	}
	frames_free(&f);
	return ok;
}

/* Rows of the parts' scatters: inputs or lids, then coordinates. */
static void assemble(struct train *t, double *row[TRAIN_PARTS], const struct frames *f, long n, const long *frame)
{
	int n_in = t->model->n_inputs, n_au = t->clip->n_au;
#pragma omp parallel for
	for (long i = 0; i < n; i++) {
		const double *g = t->g + frame[i] * n_in;
		for (int p = 0; p < 2; p++) {
			double *to = row[p] + i * t->part[p].sum.p;
			for (int k = 0; k < EYE_INPUTS; k++)
				to[k] = f->w[p][i] > 0 ? g[EYE_INPUTS * p + k] : 0;
			memcpy(to + EYE_INPUTS, f->x[p] + i * t->n_eye, (size_t)t->n_eye * sizeof *to);
		}
		double *to = row[TRAIN_SKIN] + i * t->part[TRAIN_SKIN].sum.p;
		for (int p = 0; p < 2; p++)
			for (int k = 0; k < t->n_eye; k++)
				to[p * t->n_eye + k] = t->part[p].used ? f->x[p][i * t->n_eye + k] : 0;
		memcpy(to + t->n_lid, g + SKIN_EYE_INPUTS, (size_t)n_au * sizeof *to);
		memcpy(to + t->n_lid + n_au, f->x[TRAIN_SKIN] + i * t->part[TRAIN_SKIN].n,
		       (size_t)t->part[TRAIN_SKIN].n * sizeof *to);
	}
}

static void count(struct train *t, const struct frames *f, long n)
{
	for (int p = 0; p < TRAIN_PARTS; p++)
		for (long i = 0; i < n; i++) {
			bool shown = f->share[p][i] >= least_share;
			t->part[p].outlying += shown && part_weight(&t->part[p], t->conf, f->d[p][i]) < 1;
			t->part[p].used_frames += shown;
			t->part[p].filled += 1 - f->share[p][i];
			t->part[p].numbers += 1;
		}
}

bool train_stream(struct train *t, struct err *err)
{
	struct frames f = frames_new(t, SCATTER_BLOCK);
	double *row[TRAIN_PARTS];
	long frame[SCATTER_BLOCK];
	for (int p = 0; p < TRAIN_PARTS; p++) {
		struct part *part = &t->part[p];
		part->from = p == TRAIN_SKIN ? t->n_lid + t->clip->n_au : EYE_INPUTS;
		scatter_new(&part->sum, part->from + part->n, t->clip->n <= PILOT_FRAMES ? (int)t->clip->n : 0);
		if (p == TRAIN_SKIN && t->clip->n >= LONG_CLIP)
			scatter_split(&part->sum, part->from, part->k, part->V);
		row[p] = mem_array(SCATTER_BLOCK * (size_t)part->sum.p + 1, sizeof *row[p]);
	}
	bool ok = true;
	for (long at = 0; at < t->clip->n && ok; at += SCATTER_BLOCK) {
		long n = t->clip->n - at < SCATTER_BLOCK ? t->clip->n - at : SCATTER_BLOCK;
		for (long i = 0; i < n; i++)
			frame[i] = at + i;
		ok = train_read(t, at, n, f.x, f.c, err);
		if (!ok)
			break;
		complete(t, &f, n, frame);
		count(t, &f, n);
		assemble(t, row, &f, n, frame);
		for (int p = 0; p < TRAIN_PARTS; p++)
			if (t->part[p].used)
				scatter_add(&t->part[p].sum, n, row[p], f.w[p]);
		if (t->clip->progress)
			t->clip->progress(t->clip->ctx, at + n, t->clip->n);
	}
	for (int p = 0; p < TRAIN_PARTS; p++) {
		free(row[p]);
		scatter_join(&t->part[p].sum);
	}
	frames_free(&f);
	return ok;
}
