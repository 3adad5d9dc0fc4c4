/* Chooses how many components the model keeps, by cross-validation. Components that carry little but noise cannot be predicted, and
 * as inputs of the skin's regression they make it worse: up to the configuration's numbers, the fewest are kept that no larger
 * number beats in held-out frames. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "model/train/cv.h"

static const double worth = 0.995, least_worth = 1e-9;  // a larger number must lower the error by half a per cent, and beyond rounding

/* error[k]: with k + 1 components. Returns a number of components, 1..most. */
static int fewest(const double error[], int most)
{
	int best = 0;
	if (isnan(error[0]))  // no frame was held out
		return most;
	for (int k = 1; k < most; k++)
		if (error[k] < worth * error[best] - least_worth)
			best = k;
	return best + 1;
}

/* The same frames with the first k (of most) components of each eye's lids as inputs. x: free(). */
static struct cv with_lids(const struct cv *all, int most, int k)
{
	struct cv cv = *all;
	cv.q = all->q - 2 * (most - k);
	cv.x = mem_array((size_t)cv.m * (size_t)cv.q + 1, sizeof *cv.x);
	for (long i = 0; i < cv.m; i++) {
		double *to = cv.x + i * cv.q;
		const double *from = all->x + i * all->q;
		memcpy(to, from, (size_t)k * sizeof *to);
		memcpy(to + k, from + most, (size_t)k * sizeof *to);
		memcpy(to + 2 * k, from + 2 * most, (size_t)(cv.q - 2 * k) * sizeof *to);
	}
	return cv;
}

/* Adds to error[k - 1] the skin's held-out error with k components of each eye's lids as inputs, k = 1..most. */
static void add_skin(double error[], const struct train *t, int most)
{
	struct cv all = cv_new(t, TRAIN_SKIN);
	int K = (int)fmin(all.R, t->part[TRAIN_SKIN].kept);
	double *least = mem_new((size_t)K + 1, sizeof *least);
	for (int k = 1; k <= most && K > 0; k++) {
		struct cv cv = with_lids(&all, most, k);
		cv_least(least, &cv, K);
		error[k - 1] += least[K - 1];
		free(cv.x);
	}
	free(least);
	cv_free(&all);
}

void train_choose_lids(struct train *t)
{
	int most = t->model->n_lid_pc / 2;
	double *error = mem_new((size_t)most + 1, sizeof *error), *least = mem_new((size_t)most + 1, sizeof *least);
	for (int p = TRAIN_LEFT; p <= TRAIN_RIGHT && t->conf->choose; p++) {
		if (!t->part[p].used)
			continue;
		struct cv cv = cv_new(t, p);
		int K = (int)fmin(cv.R, most);
		cv_least(least, &cv, K);
		for (int k = 0; k < most; k++)
			error[k] += least[k < K ? k : K - 1];
		cv_free(&cv);
	}
	if (t->conf->choose && (t->part[TRAIN_LEFT].used || t->part[TRAIN_RIGHT].used)) {
		if (t->part[TRAIN_SKIN].used)
			add_skin(error, t, most);
		t->model->n_lid_pc = 2 * fewest(error, most);
		t->part[TRAIN_LEFT].kept = t->part[TRAIN_RIGHT].kept = t->model->n_lid_pc / 2;
	}
	free(error);
	free(least);
}

void train_choose_skin(struct train *t)
{
	struct part *part = &t->part[TRAIN_SKIN];
	if (!t->conf->choose || !part->used)
		return;
	struct cv cv = cv_new(t, TRAIN_SKIN);
	int K = (int)fmin(cv.R, part->kept);
	double *least = mem_new((size_t)K + 1, sizeof *least);
	cv_least(least, &cv, K);
	part->kept = t->model->n_skin_pc = K > 0 ? fewest(least, K) : part->kept;
	free(least);
	cv_free(&cv);
}
