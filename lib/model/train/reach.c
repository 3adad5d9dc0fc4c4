/* What the clip does not tell: inputs of its own frames that no frame with a weight is like. Frames of lids that were lost,
 * or unlike all others, do not count; if nothing else shows a gaze or an opening like theirs, the regressions have no slope in
 * that direction, and neither held-out frames nor the jackknife show it. */
#include <math.h>
#include <stdlib.h>

#include "base/mem.h"
#include "math/regress.h"
#include "model/train/impl.h"

static const double least_share = 1e-6;   // of its mean: an input that varies less is constant
static const double least_action = 0.05;  // of an expression's strength: less is noise

/* Inputs from..from+n-1 of all, the first columns of sum. */
static void set_reach(double *reach, const struct scatter *sum, int from, int n)
{
	double *Gxx = mem_new((size_t)(n * n) + 1, sizeof *Gxx), *least = mem_new((size_t)n + 1, sizeof *least);
	for (int i = 0; i < n; i++) {
		double size = fabs(sum->mean[i]);  // 0 throughout: not measured, nothing depends on it
		least[i] = from + i >= SKIN_EYE_INPUTS ? least_action : size > 0 ? least_share * size : INFINITY;
	}
	scatter_cross(Gxx, sum, 0, n, 0, n);
	regress_reach(reach, n, Gxx, sum->weight, sum->mean, least);
	free(Gxx);
	free(least);
}

/* A line of the frames that lie outside for this part: how many, and the longest run of them. */
static void tell(struct train *t, int part, const bool *outside)
{
	static const char *const what[TRAIN_PARTS] = { "the left eye's lids are", "the right eye's lids are", "the skin is" };
	long first = 0, run = 0, longest = 0, count = 0;
	for (long i = 0; i < t->clip->n; i++) {
		run = outside[i] ? run + 1 : 0;
		count += outside[i];
		if (run > longest) {
			longest = run;
			first = i + 1 - run;
		}
	}
	t->report->outside[part] = count;
	if (count)
		train_warn(t, "%s: in %ld frames (%ld to %ld%s) %s lost or unlike all others, and no other frame shows such a gaze, opening or "
		           "expression: what the model makes of it is a guess: film more of it, sharp", t->clip->place, count, first,
		           first + longest - 1, longest < count ? " and others" : "", what[part]);
}

void train_reach(struct train *t)
{
	struct skin_model *m = t->model;
	long n = t->clip->n;
	bool *outside[TRAIN_PARTS];
	for (int eye = 0, all = EYE_INPUTS * (EYE_INPUTS + 1); eye < 2; eye++) {
		for (int i = 0; i < all; i++)
			m->lid_reach[eye * all + i] = NAN;
		if (t->part[eye].used)
			set_reach(m->lid_reach + eye * all, &t->part[eye].sum, EYE_INPUTS * eye, EYE_INPUTS);
	}
	set_reach(m->skin_reach, &t->inputs, 0, m->n_inputs);
	for (int p = 0; p < TRAIN_PARTS; p++)
		outside[p] = mem_new((size_t)n + 1, sizeof **outside);
	for (long i = 0; i < n; i++) {
		double h[TRAIN_PARTS];
		skin_model_leverage(h, m, t->g + i * m->n_inputs);
		for (int p = 0; p < TRAIN_PARTS; p++)
			outside[p][i] = t->part[p].used && h[p] > SKIN_REACH;
		// Skin that follows lids which are a guess is no second finding.
		outside[TRAIN_SKIN][i] = outside[TRAIN_SKIN][i] && !outside[TRAIN_LEFT][i] && !outside[TRAIN_RIGHT][i];
	}
	for (int p = 0; p < TRAIN_PARTS; p++) {
		tell(t, p, outside[p]);
		free(outside[p]);
	}
}
