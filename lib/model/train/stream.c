/* The pass over all frames. Block by block, frames are read, then filled in, weighed and laid out as rows of the scatters, a few at a
 * time so that they stay in the caches, then summed. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "model/train/impl.h"

enum { LONG_CLIP = 8192, ROWS = 32 };  // frames from which the faster split scatter is used; frames that a thread takes at a time

/* A block of frames: as read; weight, share measured and distance from the pilot by part. */
struct block {
	long at, n;
	double *lid, *skin, *seen;
	double *w[TRAIN_PARTS], *share[TRAIN_PARTS], *d[TRAIN_PARTS];
	double *w_inputs;  // the skin's, where all inputs are known
};

static struct block block_new(const struct train *t)
{
	size_t nu = (size_t)t->part[TRAIN_SKIN].n, n = SCATTER_BLOCK;
	struct block b = { .lid = mem_array(n * (size_t)t->n_lid + 1, sizeof(double)), .skin = mem_array(n * nu + 1, sizeof(double)),
		               .seen = mem_array(n * nu / 2 + 1, sizeof(double)) };
	for (int p = 0; p < TRAIN_PARTS; p++) {
		b.w[p] = mem_array(n, sizeof(double));
		b.share[p] = mem_array(n, sizeof(double));
		b.d[p] = mem_array(n, sizeof(double));
	}
	b.w_inputs = mem_array(n, sizeof(double));
	return b;
}

static void block_free(struct block *b)
{
	free(b->lid);
	free(b->skin);
	free(b->seen);
	for (int p = 0; p < TRAIN_PARTS; p++) {
		free(b->w[p]);
		free(b->share[p]);
		free(b->d[p]);
	}
	free(b->w_inputs);
}

/* Writes n frames as rows `to`.. of the parts' scatters: regressors (inputs; for the skin lids and action units), then
 * coordinates. */
static void assemble(struct train *t, long to, const struct frames *f, long n, const long *frame)
{
	int n_in = t->model->n_inputs, n_au = t->clip->n_au;
	for (long i = 0; i < n; i++) {
		const double *g = t->g + frame[i] * n_in;
		for (int p = 0; p < 2; p++) {
			double *row = scatter_rows(&t->part[p].sum) + (to + i) * t->part[p].sum.p;
			for (int k = 0; k < EYE_INPUTS; k++)
				row[k] = f->w[p][i] > 0 ? g[EYE_INPUTS * p + k] : 0;
			memcpy(row + EYE_INPUTS, f->x[p] + i * t->n_eye, (size_t)t->n_eye * sizeof *row);
		}
		double *row = scatter_rows(&t->part[TRAIN_SKIN].sum) + (to + i) * t->part[TRAIN_SKIN].sum.p;
		for (int p = 0; p < 2; p++)
			for (int k = 0; k < t->n_eye; k++)
				row[p * t->n_eye + k] = t->part[p].used ? f->x[p][i * t->n_eye + k] : 0;
		memcpy(row + t->n_lid, g + SKIN_EYE_INPUTS, (size_t)n_au * sizeof *row);
		memcpy(row + t->n_lid + n_au, f->x[TRAIN_SKIN] + i * t->part[TRAIN_SKIN].n,
		       (size_t)t->part[TRAIN_SKIN].n * sizeof *row);
	}
}

/* Writes n frames as rows `to`.. of the inputs' scatter; inputs of an eye that is not modelled are 0. */
static void add_inputs(struct train *t, struct block *b, long to, const double *w_skin, long n)
{
	int n_in = t->model->n_inputs;
	for (long i = 0; i < n; i++) {
		const double *g = t->g + (b->at + to + i) * n_in;
		double *row = scatter_rows(&t->inputs) + (to + i) * n_in;
		bool known = true;
		for (int k = 0; k < n_in; k++) {
			row[k] = k < SKIN_EYE_INPUTS && !t->part[k / EYE_INPUTS].used ? 0 : g[k];
			known = known && !isnan(row[k]);
		}
		b->w_inputs[to + i] = known ? w_skin[i] : 0;
		if (!known)
			memset(row, 0, (size_t)n_in * sizeof *row);
	}
}

/* Turns frames at..at+n-1 of the block, as read, into rows to be summed. f: room for ROWS frames. */
static void prepare(struct train *t, struct block *b, long at, long n, struct frames *f)
{
	long frame[ROWS];
	for (long i = 0; i < n; i++)
		frame[i] = b->at + at + i;
	train_accept(t, n, b->lid + at * t->n_lid, b->skin + at * t->part[TRAIN_SKIN].n, b->seen + at * t->part[TRAIN_SKIN].n / 2, f->x, f->c);
	for (int p = 0; p < TRAIN_PARTS; p++)
		part_complete_few(&t->part[p], (int)n, f->x[p], f->c[p], f->d[p], f->share[p]);
	train_weigh(t, f, n, frame);
	assemble(t, at, f, n, frame);
	add_inputs(t, b, at, f->w[TRAIN_SKIN], n);
	for (int p = 0; p < TRAIN_PARTS; p++) {
		memcpy(b->w[p] + at, f->w[p], (size_t)n * sizeof(double));
		memcpy(b->share[p] + at, f->share[p], (size_t)n * sizeof(double));
		memcpy(b->d[p] + at, f->d[p], (size_t)n * sizeof(double));
	}
}

static void count(struct train *t, const struct block *b)
{
	for (int p = 0; p < TRAIN_PARTS; p++)
		for (long i = 0; i < b->n; i++) {
			bool shown = b->share[p][i] >= TRAIN_LEAST_SHARE;
			t->part[p].outlying += shown && part_weight(&t->part[p], t->conf, b->d[p][i]) < 1;
			t->part[p].used_frames += shown;
			t->part[p].filled += 1 - b->share[p][i];
			t->part[p].numbers += 1;
		}
}

static void add_block(struct train *t, struct block *b)
{
#pragma omp parallel
	{
		struct frames f = frames_new(t, ROWS);
#pragma omp for schedule(dynamic)
		for (long at = 0; at < b->n; at += ROWS)
			prepare(t, b, at, b->n - at < ROWS ? b->n - at : ROWS, &f);
		frames_free(&f);
	}
	count(t, b);
	for (int p = 0; p < TRAIN_PARTS; p++)
		if (t->part[p].used)
			scatter_take(&t->part[p].sum, b->n, b->w[p]);
	scatter_take(&t->inputs, b->n, b->w_inputs);
}

bool train_stream(struct train *t, struct err *err)
{
	struct block b = block_new(t);
	for (int p = 0; p < TRAIN_PARTS; p++) {
		struct part *part = &t->part[p];
		part->from = p == TRAIN_SKIN ? t->n_lid + t->clip->n_au : EYE_INPUTS;
		scatter_new(&part->sum, part->from + part->n, t->clip->n <= PILOT_FRAMES ? (int)t->clip->n : 0);
		if (p == TRAIN_SKIN && part->used && t->clip->n >= LONG_CLIP)
			scatter_split(&part->sum, part->from, part->k, part->V);
		scatter_rows(&part->sum);
	}
	scatter_new(&t->inputs, t->model->n_inputs, 0);
	scatter_rows(&t->inputs);
	bool ok = true;
	for (; b.at < t->clip->n && ok; b.at += b.n) {
		b.n = t->clip->n - b.at < SCATTER_BLOCK ? t->clip->n - b.at : SCATTER_BLOCK;
		ok = t->clip->read(t->clip->ctx, b.at, b.n, b.lid, b.skin, b.seen, err);
		if (!ok)
			break;
		add_block(t, &b);
		if (t->clip->progress)
			t->clip->progress(t->clip->ctx, b.at + b.n, t->clip->n);
	}
	for (int p = 0; p < TRAIN_PARTS; p++)
		scatter_join(&t->part[p].sum);
	block_free(&b);
	return ok;
}
