/* The inputs of the clip: interpolates gaps, decides which eyes and action units can be modelled. */
#include <math.h>
#include <string.h>

#include "base/mem.h"
#include "model/train/impl.h"

enum { TORSION = 2 };

/* Interpolates one input over gaps of at most `longest` s, linearly; at the ends the nearest value is held. */
static void bridge(double *g, int stride, const struct train_clip *clip, double longest)
{
	long before = -1;
	for (long i = 0; i <= clip->n; i++) {
		if (i < clip->n && isnan(g[i * stride]))
			continue;
		long from = before + 1;
		bool first = before < 0, last = i == clip->n;
		double t0 = clip->time[first ? 0 : before], t1 = clip->time[last ? clip->n - 1 : i];
		if (from < i && !(first && last) && t1 - t0 <= longest)
			for (long k = from; k < i; k++) {
				double a = t1 > t0 ? (clip->time[k] - t0) / (t1 - t0) : 0;
				a = first ? 1 : last ? 0 : a;
				g[k * stride] = (first ? 0 : (1 - a) * g[before * stride]) + (last ? 0 : a * g[i * stride]);
			}
		before = i;
	}
}

static long measured(const struct train *t, int input)
{
	long n = 0;
	for (long i = 0; i < t->clip->n; i++)
		n += !isnan(t->g[i * t->model->n_inputs + input]);
	return n;
}

static void set_column(struct train *t, int input, double value)
{
	for (long i = 0; i < t->clip->n; i++)
		t->g[i * t->model->n_inputs + input] = value;
}

/* Range and mean of an input as measured, into the model. */
static void range_of(struct train *t, int input)
{
	struct skin_model *m = t->model;
	double low = INFINITY, high = -INFINITY, sum = 0, n = 0;
	for (long i = 0; i < t->clip->n; i++) {
		double x = t->clip->g[i * m->n_inputs + input];
		if (isnan(x))
			continue;
		low = fmin(low, x);
		high = fmax(high, x);
		sum += x;
		n++;
	}
	m->low[input] = n > 0 ? low : NAN;
	m->high[input] = n > 0 ? high : NAN;
	m->mean[input] = n > 0 ? sum / n : NAN;
}

/* Action units: one that is never shown is set to 0, with a warning; not measured counts as 0. */
static void expressions(struct train *t)
{
	struct skin_model *m = t->model;
	for (int a = SKIN_EYE_INPUTS; a < m->n_inputs; a++) {
		if (!(m->high[a] >= 0.5)) {
			train_warn(t, "expression %d of %d is never shown in the clip: film it, or take its line out of capture.conf",
			           a - SKIN_EYE_INPUTS + 1, t->clip->n_au);
			set_column(t, a, 0);
		}
		for (long i = 0; i < t->clip->n; i++)
			if (isnan(t->g[i * m->n_inputs + a]))
				t->g[i * m->n_inputs + a] = 0;
	}
}

bool train_inputs(struct train *t, struct err *err)
{
	const struct train_clip *clip = t->clip;
	int n = t->model->n_inputs;
	t->g = mem_array((size_t)clip->n * (size_t)n + 1, sizeof *t->g);
	memcpy(t->g, clip->g, (size_t)clip->n * (size_t)n * sizeof *t->g);
	for (int i = 0; i < n; i++)
		range_of(t, i);
	known_of(&t->model->known, clip->n, clip->g, n, t->conf->beyond);
	for (int i = 0; i < SKIN_EYE_INPUTS; i++) {
		long have = measured(t, i);
		bool enough = have > 0 && (double)have >= t->conf->min_seen * (double)clip->n;
		if (!enough && i % EYE_INPUTS == TORSION)
			set_column(t, i, 0);
		else if (!enough)
			t->eye[i / EYE_INPUTS] = false;
		bridge(t->g + i, n, clip, i % EYE_INPUTS == TORSION ? INFINITY : t->conf->gap_s);
	}
	if (!t->eye[0] && !t->eye[1])
		return err_set(err, "%s: gaze and lids of neither eye are measured in enough frames (train.min_seen = %g): film an open eye, close and sharp",
		               clip->place, t->conf->min_seen);
	expressions(t);
	return true;
}
