/* Finds frames of the clip at which the model extrapolates, by the leverage of their inputs (Hoaglin and Welsch 1978). Frames whose
 * lids were lost, or outliers, have no weight; where no other frame shows a similar gaze or opening, the regressions have no slope in
 * that direction, and neither the held-out error nor the jackknife reveals it. */
#include <math.h>
#include <stdlib.h>

#include "base/mem.h"
#include "math/regress.h"
#include "model/train/impl.h"

static const double least_share = 1e-6;   // of an input's mean: one that varies less is constant
static const double least_action = 0.05;  // of an expression's strength: less is noise

/* Leverage factor (regress_reach) of the inputs from..from+n-1, which are the first n columns of sum. */
static void set_reach(double *reach, const struct scatter *sum, int from, int n)
{
	double *Gxx = mem_new((size_t)(n * n) + 1, sizeof *Gxx), *least = mem_new((size_t)n + 1, sizeof *least);
	for (int i = 0; i < n; i++) {
		double size = fabs(sum->mean[i]);  // 0 throughout: not measured, the model does not depend on it
		least[i] = from + i >= SKIN_EYE_INPUTS ? least_action : size > 0 ? least_share * size : INFINITY;
	}
	scatter_cross(Gxx, sum, 0, n, 0, n);
	regress_reach(reach, n, Gxx, sum->weight, sum->mean, least);
	free(Gxx);
	free(least);
}

/* Warns of a part's extrapolated frames: how many, and the longest run of them. */
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
	for (int i = 0; i < m->n_inputs * (m->n_inputs + 1); i++)
		m->skin_reach[i] = NAN;
	if (t->part[TRAIN_SKIN].used)
		set_reach(m->skin_reach, &t->inputs, 0, m->n_inputs);
	for (int p = 0; p < TRAIN_PARTS; p++)
		outside[p] = mem_new((size_t)n + 1, sizeof **outside);
	for (long i = 0; i < n; i++) {
		double h[TRAIN_PARTS];
		skin_model_leverage(h, m, t->g + i * m->n_inputs);
		for (int p = 0; p < TRAIN_PARTS; p++)
			outside[p][i] = t->part[p].used && h[p] > SKIN_REACH;
		// Skin follows the lids: where these are extrapolated already, that is reported once.
		outside[TRAIN_SKIN][i] = outside[TRAIN_SKIN][i] && !outside[TRAIN_LEFT][i] && !outside[TRAIN_RIGHT][i];
	}
	for (int p = 0; p < TRAIN_PARTS; p++) {
		tell(t, p, outside[p]);
		free(outside[p]);
	}
}
