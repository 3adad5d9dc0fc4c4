/* Reads frames of the clip and marks what was not measured. */
#include <math.h>
#include <stdlib.h>

#include "base/mem.h"
#include "model/train/impl.h"

static const double farthest = 1e6;  // px: nothing in a picture is further away

/* A number and its confidence; NAN and 0 where it is not measured. */
static inline void keep_if_measured(double *x, double *c, double to, double belief)
{
	bool ok = fabs(to) <= farthest && belief > 0;
	*x = ok ? to : NAN;
	*c = !ok ? 0 : belief < 1 ? belief : 1;
}

/* Whether all measured points lie in the very same place: some trackers write that when they have lost the part. */
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
