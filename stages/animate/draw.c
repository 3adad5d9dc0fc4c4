#include "stages/animate/draw.h"

#include <math.h>
#include <stdlib.h>

#include "base/mem.h"
#include "image/chart.h"

enum { MOST_POINTS = 3000, WIDTH = 640, HEIGHT = 260 };
static const char *const colours[] = { "#1f77b4", "#d62728", "#2ca02c", "#9467bd", "#ff7f0e", "#8c564b", "#17becf" };

/* One column of every frame, thinned to MOST_POINTS. free(). */
static double *column(const struct animation *a, const double *of, int stride, int which, int *n)
{
	long step = 1 + a->n / MOST_POINTS;
	double *x = mem_new((size_t)(a->n / step + 2), sizeof *x);
	*n = 0;
	for (long i = 0; i < a->n; i += step)
		x[(*n)++] = of ? of[i * stride + which] : (double)i / a->fps;
	return x;
}

/* Peak velocity against amplitude, with the configured curve. */
static void main_sequence(struct chart_series out[2], const struct animation *a, const struct saccade_conf *conf,
                          double *memory)
{
	double *x = memory, *y = x + a->n_saccades + 1, *lx = y + a->n_saccades + 1, *ly = lx + 64, top = 10;
	for (int i = 0; i < a->n_saccades; i++) {
		x[i] = a->saccades[i].amplitude;
		y[i] = a->saccades[i].peak;
		top = fmax(top, x[i]);
	}
	for (int i = 0; i < 64; i++) {
		lx[i] = top * i / 63;
		ly[i] = conf->peak_ratio * lx[i] / (conf->duration_s + conf->duration_per_deg * lx[i]);
	}
	out[0] = (struct chart_series){ "main sequence", "#7f7f7f", "5 4", 64, lx, ly, 0, false, false };
	out[1] = (struct chart_series){ "saccades", colours[1], 0, a->n_saccades, x, y, 0, true, true };
}

bool draw_animation(const char *path, const struct animation *a, const struct skin_model *m, const struct animate_conf *conf,
                    const char *made_by, struct err *err)
{
	static const int gaze[2][2] = { { 0, 5 }, { 1, 6 } }, lids[4] = { 3, 4, 8, 9 };
	static const char *const eyes[] = { "left eye", "right eye" };
	static const char *const lid_names[] = { "left upper", "left lower", "right upper", "right lower" };
	struct chart_series series[5][8];
	struct chart_panel panels[5];
	double *owned[40], *memory = mem_new(2 * (size_t)a->n_saccades + 200, sizeof *memory);
	int n = 0, count, panels_n = 3, n_au = m->n_au < 6 ? m->n_au : 6;
	double *time = owned[n++] = column(a, 0, 0, 0, &count);
	for (int axis = 0; axis < 2; axis++) {
		for (int e = 0; e < 2; e++)
			series[axis][e] = (struct chart_series){ eyes[e], colours[e], e ? "5 3" : 0, count, time,
				                                     owned[n++] = column(a, a->g, a->n_inputs, gaze[axis][e], &count), 0, false, false };
		series[axis][2] = (struct chart_series){ "head", colours[2], "2 3", count, time, owned[n++] = column(a, a->head, 2, axis, &count),
			                                     0, false, false };
		panels[axis] = (struct chart_panel){ axis ? "Vertical gaze in the head, up" : "Horizontal gaze in the head, to the person's left",
			                                 "s", "degrees", 3, series[axis], NAN, NAN };
	}
	for (int k = 0; k < 4; k++)
		series[2][k] = (struct chart_series){ lid_names[k], colours[k], k % 2 ? "5 3" : 0, count, time,
			                                  owned[n++] = column(a, a->controls, a->n_inputs, lids[k], &count), 0, false, false };
	panels[2] = (struct chart_panel){ "Lids: 0 shut, 1 wide open", "s", "aperture control", 4, series[2], NAN, NAN };
	if (a->n_saccades) {
		main_sequence(series[3], a, &conf->gaze.saccade, memory);
		panels[panels_n++] = (struct chart_panel){ "Saccades: main sequence", "amplitude, degrees", "peak velocity, degrees/s", 2,
			                                       series[3], 0, NAN };
	}
	for (int k = 0; k < n_au; k++)
		series[4][k] = (struct chart_series){ m->au_names[k], colours[k], 0, count, time,
			                                  owned[n++] = column(a, a->g, a->n_inputs, SKIN_EYE_INPUTS + k, &count), 0, false, false };
	if (n_au)
		panels[panels_n++] = (struct chart_panel){ "Expressions", "s", "strength", n_au, series[4], 0, 1.02 };
	bool ok = chart_save(path, 2, WIDTH, HEIGHT, panels_n, panels, made_by, err);
	for (int i = 0; i < n; i++)
		free(owned[i]);
	free(memory);
	return ok;
}
