#include "rig/drive.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "base/csv.h"
#include "base/mem.h"
#include "model/gaze_table.h"

/* n frames of zeros. */
static struct drive drive_new(int n, int n_inputs)
{
	return (struct drive){ .n = n, .n_inputs = n_inputs, .time = mem_new((size_t)n + 1, sizeof(double)),
		                   .controls = mem_new((size_t)n * (size_t)n_inputs + 1, sizeof(double)) };
}

void drive_free(struct drive *drive)
{
	free(drive->time);
	free(drive->controls);
	*drive = (struct drive){ 0 };
}

/* Column of each input; -1 where there is none. True when apertures are normalised already. */
static bool columns_of(int *column, const struct csv_table *t, const struct skin_model *model)
{
	bool normalised = csv_column(t, "a4") >= 0;
	char name[32];
	for (int i = 0; i < SKIN_EYE_INPUTS; i++) {
		bool aperture = i % 5 >= 3;
		snprintf(name, sizeof name, aperture ? normalised ? "a%d" : "g%d_px" : "g%d_deg", i + 1);
		column[i] = csv_column(t, name);
	}
	for (int a = 0; a < model->n_au; a++) {
		column[SKIN_EYE_INPUTS + a] = csv_column(t, model->au_names[a]);
		snprintf(name, sizeof name, "au%d", a + 1);
		if (column[SKIN_EYE_INPUTS + a] < 0)
			column[SKIN_EYE_INPUTS + a] = csv_column(t, name);
	}
	return normalised;
}

/* Fills the gaps of one input: linearly between its neighbours in time, constant before the first and after the last; `otherwise` when
 * there is no value at all. Returns how many were filled. */
static long fill(struct drive *d, int input, double otherwise)
{
	long filled = 0;
	int last = -1;
	for (int f = 0; f <= d->n; f++) {
		if (f < d->n && isnan(drive_at(d, f)[input]))
			continue;
		for (int k = last + 1; k < f; k++) {
			double left = last >= 0 ? drive_at(d, last)[input] : NAN, right = f < d->n ? drive_at(d, f)[input] : NAN;
			double t = last >= 0 && f < d->n ? (d->time[k] - d->time[last]) / (d->time[f] - d->time[last]) : 0;
			drive_at(d, k)[input] = isnan(left) ? isnan(right) ? otherwise : right : isnan(right) ? left : left + t * (right - left);
			filled++;
		}
		last = f;
	}
	return filled;
}

static bool take(struct drive *d, const struct csv_table *t, const struct skin_model *model, const char *path, struct err *err)
{
	int time = csv_need(t, "time_s", path, err), *column = mem_new((size_t)model->n_inputs + 1, sizeof *column);
	bool ok = time >= 0, normalised = columns_of(column, t, model);
	for (int f = 0; f < d->n && ok; f++) {
		double *c = drive_at(d, f);
		d->time[f] = csv_at(t, f, time);
		if (!isfinite(d->time[f]) || (f && d->time[f] <= d->time[f - 1]))
			ok = err_set(err, "%s:%d: time_s = %g: must be a number that grows from row to row", path, t->line[f], d->time[f]);
		for (int i = 0; i < d->n_inputs; i++)
			c[i] = csv_at(t, f, column[i]);
		if (!normalised)
			skin_model_controls(c, model, c);
	}
	const double left_to_us[2] = { column[3] < 0 && column[4] < 0, column[8] < 0 && column[9] < 0 };  // eyes of which the file tells no aperture
	for (int i = 0; i < d->n_inputs && ok; i++)
		d->filled += fill(d, i, isfinite(model->rest_controls[i]) ? model->rest_controls[i] : 0);
	for (int f = 0; f < d->n && ok; f++)
		skin_model_express(drive_at(d, f), model, left_to_us);
	free(column);
	return ok;
}

bool drive_load(struct drive *d, const struct skin_model *model, const char *path, struct err *err)
{
	struct csv_table t = { 0 };
	*d = (struct drive){ 0 };
	bool ok = csv_read(&t, path, err) && gaze_table_check(&t, path, err);
	if (ok && (t.n_rows < 1 || t.n_rows > 1 << 24))
		ok = err_set(err, "%s: %ld frames, must be 1 .. 16777216", path, t.n_rows);
	if (ok) {
		*d = drive_new((int)t.n_rows, model->n_inputs);
		ok = take(d, &t, model, path, err);
	}
	csv_table_free(&t);
	if (!ok)
		drive_free(d);
	return ok;
}

/* The usual apertures of an eye at a gaze, eq. 3.11. */
static void usual(double a[2], const struct rig *rig, int eye, double horizontal, double vertical)
{
	double gaze[3] = { horizontal, vertical, 0 };
	known_hold(gaze, &rig->known, eye);
	for (int k = 0; k < 2; k++) {
		const double *b = rig->baseline[2 * eye + k];
		a[k] = b[0] * gaze[0] + b[1] * gaze[1] + b[2];
	}
}

void drive_look(double *c, const struct rig *rig, double horizontal, double vertical, double aperture)
{
	for (int i = 0; i < rig->n_inputs; i++)
		c[i] = 0;
	for (int eye = 0; eye < 2; eye++) {
		usual(c + 5 * eye + 3, rig, eye, horizontal, vertical);
		for (int k = 0; k < 2; k++)
			c[5 * eye + 3 + k] *= aperture;
		c[5 * eye] = horizontal;
		c[5 * eye + 1] = vertical;
	}
}

void drive_express(double *c, const struct rig *rig, int k, double strength, double aperture)
{
	c[SKIN_EYE_INPUTS + k] = strength;
	for (int eye = 0; eye < 2; eye++)
		express_eye(c + 5 * eye + 3, eye, 1, &strength, (const double(*)[EXPRESS_LIDS])rig->expression + k, rig->aperture_px, aperture);
}

double drive_opened(const struct rig *rig, const double *c, int eye)
{
	const double *px = rig->aperture_px + 2 * eye, *now = c + 5 * eye + 3;
	double a[2];
	usual(a, rig, eye, c[5 * eye], c[5 * eye + 1]);
	express_eye(a, eye, rig->n_inputs - SKIN_EYE_INPUTS, c + SKIN_EYE_INPUTS, (const double(*)[EXPRESS_LIDS])rig->expression, rig->aperture_px, 1);
	const double all = px[0] * a[0] + px[1] * a[1];
	return all > 0.05 * (px[0] + px[1]) ? fmin(fmax((px[0] * now[0] + px[1] * now[1]) / all, 0), 1) : 1;
}
