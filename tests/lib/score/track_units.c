#include "tests/lib/score/track_units.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/csv.h"
#include "base/json.h"
#include "base/mem.h"
#include "base/npy/npy.h"

static const double begins = 0.03, least = 0.05;  // shares of the peak's weight; weight of a unit that is shown at all

/* The weight of a unit in every frame; null: there is none. free(). */
static double *weights(long *frames, const char *truth, const char *unit)
{
	struct npy a;
	struct err none = { 0 };
	char *npz = mem_printf("%s/truth.npz", truth), *json = mem_printf("%s/truth.json", truth);
	json_t *j = json_read(json, 1 << 24, &none), *name;
	size_t at;
	long column = -1;
	double *x = 0;
	json_array_foreach(json_object_get(j, "au_names"), at, name)
		if (!strcmp(json_string_value(name), unit))
			column = (long)at;
	if (column >= 0 && npz_read(&a, npz, "au_weights", NPY_LIMIT, &none)) {
		double *all = npy_doubles(&a);
		*frames = a.shape[0];
		x = mem_array((size_t)*frames + 1, sizeof *x);
		for (long f = 0; f < *frames; f++)
			x[f] = all[f * a.shape[1] + column];
		free(all);
		npy_free(&a);
	}
	json_decref(j);
	free(npz);
	free(json);
	return x;
}

bool track_units_mark(int frame[2], const char *truth, const char *unit)
{
	long n = 0, peak = 0;
	double *w = weights(&n, truth, unit);
	for (long f = 1; w && f < n; f++)
		peak = w[f] > w[peak] ? f : peak;
	bool shown = w && w[peak] > least;
	long neutral = peak;
	while (shown && neutral > 0 && w[neutral] > begins * w[peak])
		neutral--;
	frame[0] = (int)neutral;
	frame[1] = (int)peak;
	free(w);
	return shown && neutral < peak;
}

bool track_units_score(struct spread *all, struct spread *shown, struct spread *rest, const char *dir, const char *truth, int n,
                       const char *const units[], struct err *err)
{
	struct csv_table gaze;
	char *path = mem_printf("%s/work/skin/gaze.csv", dir);
	double *e[3] = { 0 };
	long m[3] = { 0 };
	bool ok = csv_read(&gaze, path, err);
	for (int k = 0; k < n && ok; k++) {
		int mark[2];
		long frames = 0;
		char name[16];
		snprintf(name, sizeof name, "au%d", k + 1);
		double *w = weights(&frames, truth, units[k]);
		ok = w && track_units_mark(mark, truth, units[k]) && csv_column(&gaze, name) >= 0;
		for (int i = 0; i < 3; i++)
			e[i] = mem_grow(e[i], (size_t)(m[i] + frames) + 1, sizeof *e[i]);
		for (long f = 0; f < frames && ok; f++) {
			double is = fmax(0, fmin(1, (w[f] - w[mark[0]]) / (w[mark[1]] - w[mark[0]])));
			double off = fabs(csv_at(&gaze, f, csv_column(&gaze, name)) - is);
			e[0][m[0]++] = off;
			if (is > 0.5)
				e[1][m[1]++] = off;
			if (is < 0.02)
				e[2][m[2]++] = off;
		}
		free(w);
	}
	if (!ok && !err_is(err))
		err_set(err, "%s: no strengths of what the truth shows", path);
	*all = spread_of(m[0], e[0]);
	*shown = spread_of(m[1], e[1]);
	*rest = spread_of(m[2], e[2]);
	for (int i = 0; i < 3; i++)
		free(e[i]);
	csv_table_free(&gaze);
	free(path);
	return ok;
}
