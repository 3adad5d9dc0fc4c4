#include "motion/script.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "model/gaze_table.h"
#include "motion/saccade.h"

enum { SCREEN_PX = 1000000 };  // no screen is that large

static const struct {
	const char *name;
	double low, high;
	const char *unit;
} keys[KEYS] = {
	[KEY_HORIZONTAL] = { "horizontal_deg", -80, 80, "degrees" }, [KEY_VERTICAL] = { "vertical_deg", -80, 80, "degrees" },
	[KEY_DISTANCE] = { "distance_mm", 50, 1e7, "mm" },           [KEY_PURSUIT] = { "pursuit", 0, 1, "" },
	[KEY_HEAD_H] = { "head_horizontal_deg", -90, 90, "degrees" }, [KEY_HEAD_V] = { "head_vertical_deg", -90, 90, "degrees" },
	[KEY_WINK_LEFT] = { "wink_left", 0, 1, "" },                  [KEY_WINK_RIGHT] = { "wink_right", 0, 1, "" },
	[KEY_OPENNESS] = { "openness", 0, 3, "" },                   [KEY_BLINK] = { "blink", 0, 2, "" },
};

void script_free(struct script *s)
{
	for (int k = 0; k < KEYS; k++) {
		free(s->key[k].t);
		free(s->key[k].v);
	}
	for (int a = 0; s->au && a < s->n_au; a++) {
		free(s->au[a].t);
		free(s->au[a].v);
	}
	free(s->au);
	free(s->time);
	free(s->g);
	free(s->screen);
	*s = (struct script){ 0 };
}

static bool read_track(struct script_track *track, const struct csv_table *table, int column, double low, double high,
                       const char *unit, const char *path, struct err *err)
{
	int time = csv_column(table, "time_s");
	track->t = mem_new((size_t)table->n_rows + 1, sizeof *track->t);
	track->v = mem_new((size_t)table->n_rows + 1, sizeof *track->v);
	for (long r = 0; r < table->n_rows && column >= 0; r++) {
		double v = csv_at(table, r, column);
		if (isnan(v))
			continue;
		if (v < low || v > high)
			return err_set(err, "%s:%d: %s = %g: must be in [%g, %g]%s%s", path, table->line[r], table->names[column], v, low,
			               high, *unit ? " " : "", unit);
		track->t[track->n] = csv_at(table, r, time);
		track->v[track->n++] = v;
	}
	return true;
}

static bool check_times(struct script *s, const struct csv_table *table, const char *path, struct err *err)
{
	int time = csv_need(table, "time_s", path, err);
	if (time < 0)
		return false;
	if (!table->n_rows)
		return err_set(err, "%s: no row below the head line", path);
	for (long r = 0; r < table->n_rows; r++) {
		double t = csv_at(table, r, time);
		if (!(t >= 0 && t <= 86400))
			return err_set(err, "%s:%d: time_s = %g: must be in [0, 86400] s", path, table->line[r], t);
		if (r && !(t > csv_at(table, r - 1, time)))
			return err_set(err, "%s:%d: time_s = %g: must be greater than in the line before", path, table->line[r], t);
	}
	s->first = csv_at(table, 0, time);
	s->last = csv_at(table, table->n_rows - 1, time);
	return true;
}

/* Which expression a column stands for: its name, or auN; -1: none. */
static int expression_of(const struct skin_model *m, const char *name)
{
	for (int a = 0; a < m->n_au; a++) {
		char number[24];
		snprintf(number, sizeof number, "au%d", a + 1);
		if (!strcmp(name, m->au_names[a]) || !strcmp(name, number))
			return a;
	}
	return -1;
}

/* The error of a column that is neither; lists the expressions that the model has. Always false. */
static bool no_such_column(const char *name, const struct skin_model *m, const char *path, struct err *err)
{
	err_set(err, "%s: column %s: must be a key (animate --help) or an expression of capture.conf: there %s", path, name,
	        m->n_au ? "are" : "is none");
	for (int a = 0; a < m->n_au; a++) {
		size_t n = strlen(err->msg);
		snprintf(err->msg + n, sizeof err->msg - n, "%s %s", a ? "," : "", m->au_names[a]);
	}
	return false;
}

static bool read_keys(struct script *s, const struct csv_table *table, const struct skin_model *m, const char *path,
                      struct err *err)
{
	s->au = mem_new((size_t)m->n_au + 1, sizeof *s->au);
	s->n_au = m->n_au;
	if ((csv_column(table, "horizontal_deg") < 0) != (csv_column(table, "vertical_deg") < 0))
		return err_set(err, "%s: horizontal_deg and vertical_deg: both or neither", path);
	for (int c = 0; c < table->n_columns; c++) {
		const char *name = table->names[c];
		int key = -1, au = expression_of(m, name);
		for (int k = 0; k < KEYS; k++)
			key = strcmp(name, keys[k].name) ? key : k;
		if (key >= 0 && !read_track(&s->key[key], table, c, keys[key].low, keys[key].high, keys[key].unit, path, err))
			return false;
		if (key < 0 && au >= 0 && !read_track(&s->au[au], table, c, 0, 1, "", path, err))
			return false;
		if (key < 0 && au < 0 && strcmp(name, "time_s") && strcmp(name, "frame"))
			return no_such_column(name, m, path, err);
	}
	if (s->key[KEY_HORIZONTAL].n != s->key[KEY_VERTICAL].n)
		return err_set(err, "%s: horizontal_deg and vertical_deg: both or neither in each line", path);
	return true;
}

static bool read_recorded(struct script *s, const struct csv_table *table, const struct skin_model *m, const char *path,
                          struct err *err)
{
	if (!gaze_table_check(table, path, err))
		return false;
	s->g = mem_new((size_t)s->n * (size_t)m->n_inputs + 1, sizeof *s->g);
	for (int i = 0; i < m->n_inputs; i++) {
		char au[24];
		snprintf(au, sizeof au, "au%d", i - SKIN_EYE_INPUTS + 1);
		int c = csv_column(table, i < SKIN_EYE_INPUTS ? gaze_columns[i] : au);
		bool angle = i < SKIN_EYE_INPUTS && i % 5 < 3;
		for (long r = 0; r < s->n; r++) {
			double v = csv_at(table, r, c);
			if (angle && fabs(v) > 90)
				return err_set(err, "%s:%d: %s = %g: must be in [-90, 90] degrees", path, table->line[r], gaze_columns[i], v);
			s->g[r * m->n_inputs + i] = v;
			s->has_apertures |= i < SKIN_EYE_INPUTS && i % 5 >= 3 && !isnan(v);
		}
	}
	return true;
}

bool script_read(struct script *s, const char *path, const struct skin_model *m, struct err *err)
{
	struct csv_table table;
	*s = (struct script){ 0 };
	bool ok = csv_read(&table, path, err) && check_times(s, &table, path, err);
	if (ok) {
		int x = csv_column(&table, "x_px"), y = csv_column(&table, "y_px");
		s->kind = csv_column(&table, "g1_deg") >= 0 ? SCRIPT_RECORDED : x >= 0 && y >= 0 ? SCRIPT_SCREEN : SCRIPT_KEYS;
		s->n = s->kind == SCRIPT_KEYS ? 0 : table.n_rows;
		s->time = mem_new((size_t)s->n + 1, sizeof *s->time);
		s->screen = mem_new(2 * (size_t)s->n + 1, sizeof *s->screen);
		for (long r = 0; r < s->n; r++) {
			s->time[r] = csv_at(&table, r, csv_column(&table, "time_s"));
			s->screen[2 * r] = csv_at(&table, r, x);
			s->screen[2 * r + 1] = csv_at(&table, r, y);
		}
		ok = s->kind == SCRIPT_KEYS ? read_keys(s, &table, m, path, err)
		     : s->kind == SCRIPT_RECORDED ? read_recorded(s, &table, m, path, err)
		     : csv_in_range(&table, x, -SCREEN_PX, SCREEN_PX, path, err) && csv_in_range(&table, y, -SCREEN_PX, SCREEN_PX, path, err);
	}
	csv_table_free(&table);
	return ok;
}

/* Index of the last key at or before t; -1: none. */
static int key_before(const struct script_track *track, double t)
{
	int low = -1, high = track->n;
	while (high - low > 1) {
		int mid = (low + high) / 2;
		*(track->t[mid] <= t ? &low : &high) = mid;
	}
	return low;
}

/* Value at t, held from key to key. */
static double held(const struct script_track *track, double t, double otherwise)
{
	int i = key_before(track, t);
	return !track->n ? otherwise : track->v[i < 0 ? 0 : i];
}

double script_smooth(const struct script_track *track, double t, double otherwise)
{
	int i = key_before(track, t);
	if (!track->n)
		return otherwise;
	if (i < 0 || i + 1 == track->n)
		return track->v[i < 0 ? 0 : i];
	double a = (t - track->t[i]) / (track->t[i + 1] - track->t[i]);
	return track->v[i] + (track->v[i + 1] - track->v[i]) * minimum_jerk(a);
}

/* Whether the target moves steadily to the key at time t. */
static bool is_steady(const struct script_track *pursuit, double t)
{
	int i = key_before(pursuit, t);
	return i >= 0 && pursuit->t[i] >= t && pursuit->v[i] >= 0.5;
}

void script_target(double out[2], double *distance, const struct script *s, double t)
{
	const struct script_track *h = &s->key[KEY_HORIZONTAL], *v = &s->key[KEY_VERTICAL];
	out[0] = held(h, t, 0);
	out[1] = held(v, t, 0);
	*distance = held(&s->key[KEY_DISTANCE], t, INFINITY);
	int i = key_before(h, t);
	if (i < 0 || i + 1 >= h->n || !is_steady(&s->key[KEY_PURSUIT], h->t[i + 1]))
		return;
	double a = (t - h->t[i]) / (h->t[i + 1] - h->t[i]), to = held(&s->key[KEY_DISTANCE], h->t[i + 1], INFINITY);
	out[0] += a * (h->v[i + 1] - h->v[i]);
	out[1] += a * (v->v[i + 1] - v->v[i]);
	if (isfinite(*distance) && isfinite(to))
		*distance += a * (to - *distance);
}
