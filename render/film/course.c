/* Gaze, how the head is turned, openings and blinks over time, as one SVG. */
#include <math.h>
#include <stdlib.h>

#include "base/csv.h"
#include "base/json.h"
#include "base/mem.h"
#include "image/chart.h"
#include "render/film/film.h"

enum { PANELS = 4, SIDES = 2, WIDTH = 1120, HEIGHT = 200, JSON_LIMIT = 1 << 26 };

static const char *const sides[SIDES] = { "left", "right" }, *const colours[SIDES] = { "#1f77b4", "#d62728" };
static const char *const turns[2] = { "aside", "up" }, *const turn_names[2] = { "head_h_deg", "head_v_deg" }, *const turn_colours[2] = { "#444444", "#2ca02c" };

static double *column(const struct csv_table *t, const char *name)
{
	const int at = csv_column(t, name);
	double *x = mem_array((size_t)t->n_rows + 1, sizeof *x);
	for (long i = 0; i < t->n_rows; i++)
		x[i] = csv_at(t, i, at);
	return x;
}

/* Height of the opening: above and below where the lids meet. */
static double *opening(const struct csv_table *t, const char *up, const char *low)
{
	double *a = column(t, up), *b = column(t, low);
	for (long i = 0; i < t->n_rows; i++)
		a[i] += b[i];
	free(b);
	return a;
}

/* Times and values of the blinks' peaks of one eye. Returns how many. */
static int peaks(double x[], double y[], int most, const json_t *blinks, int side, const double *time, const double *open, long n)
{
	const json_t *blink;
	size_t i;
	int m = 0;
	json_array_foreach(blinks, i, blink) {
		const char *eye = json_string_value(json_object_get(blink, "eye"));
		const long peak = (long)json_integer_value(json_object_get(blink, "peak"));
		if (!eye || (eye[0] == 'r') != side || peak < 0 || peak >= n || m == most)
			continue;
		x[m] = time[peak];
		y[m++] = isfinite(open[peak]) ? open[peak] : 0;
	}
	return m;
}

bool film_course(struct skin_job *job, const char *rel, int n, const char *const in[], struct err *err)
{
	enum { MOST = 4096 };
	static const char *const names[SIDES][5] = { { "g1_deg", "g2_deg", "g4_px", "g5_px", "sigma_g1_deg" }, { "g6_deg", "g7_deg", "g9_px", "g10_px", "sigma_g6_deg" } };
	struct csv_table table = { 0 };
	json_t *track = json_read(stage_path(job->stage, "%s", in[1]), JSON_LIMIT, err);
	if (!track || !csv_read(&table, stage_path(job->stage, "%s", in[0]), err) || !table.n_rows) {
		json_decref(track);
		csv_table_free(&table);
		return !err_is(err);
	}
	double *time = column(&table, "time_s"), *gaze[2][SIDES], *head[2], *open[SIDES], *at[SIDES][2];
	struct chart_series series[PANELS][2 * SIDES];
	const int rows = (int)table.n_rows;
	for (int e = 0; e < SIDES; e++) {
		for (int k = 0; k < 2; k++) {
			gaze[k][e] = column(&table, names[e][k]);
			series[k][e] = (struct chart_series){ sides[e], colours[e], 0, rows, time, gaze[k][e], 0, false, false };
			at[e][k] = mem_array(MOST, sizeof(double));
		}
		open[e] = opening(&table, names[e][2], names[e][3]);
		series[2][e] = (struct chart_series){ sides[e], colours[e], 0, rows, time, open[e], 0, false, false };
		const int m = peaks(at[e][0], at[e][1], MOST, json_object_get(track, "blinks"), e, time, open[e], rows);
		series[2][SIDES + e] = (struct chart_series){ e ? "right blinks" : "left blinks", colours[e], 0, m, at[e][0], at[e][1], 0, true, true };
	}
	for (int k = 0; k < 2; k++) {
		head[k] = column(&table, turn_names[k]);
		series[3][k] = (struct chart_series){ turns[k], turn_colours[k], 0, rows, time, head[k], 0, false, false };
	}
	const struct chart_panel panels[PANELS] = {
		{ "Gaze, horizontal (+: the person's left)", "s", "degrees", SIDES, series[0], NAN, NAN },
		{ "Gaze, vertical (+: up)", "s", "degrees", SIDES, series[1], NAN, NAN },
		{ "Head, turned aside (+: to the person's left) and up", "s", "degrees", 2, series[3], NAN, NAN },
		{ "Opening between the lids", "s", "px", 2 * SIDES, series[2], NAN, NAN },
	};
	bool ok = chart_save(stage_path(job->stage, "%s", rel), 1, WIDTH, HEIGHT, PANELS, panels, stage_made_by(job->stage, n, in), err);
	for (int e = 0; e < SIDES; e++) {
		for (int k = 0; k < 2; k++) {
			free(gaze[k][e]);
			free(at[e][k]);
		}
		free(open[e]);
		free(head[e]);
	}
	free(time);
	json_decref(track);
	csv_table_free(&table);
	return ok;
}
