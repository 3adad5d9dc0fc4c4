#include "track/lid/margin.h"

#include <math.h>

enum { SAMPLES = 33, MIDDLE = SAMPLES / 2 };

static void mean_of(double out[3], double v[SAMPLES][3], int first, int last)
{
	for (int c = 0; c < 3; c++) {
		out[c] = 0;
		for (int k = first; k <= last; k++)
			out[c] += v[k][c] / (last - first + 1);
	}
}

/* Place along the profile (px, outward positive) of the step from eye to lid: the sharp step of equal area. Returns the
 * contrast of the two, grey levels. */
static double step_at(double *at, double v[SAMPLES][3], double px)
{
	double eye[3], lid[3], along[3], size = 0;
	mean_of(eye, v, 0, MIDDLE - 6);
	mean_of(lid, v, MIDDLE + 4, MIDDLE + 9);
	for (int c = 0; c < 3; c++) {
		along[c] = lid[c] - eye[c];
		size += along[c] * along[c];
	}
	double area = 0;
	for (int k = MIDDLE - 9; k <= MIDDLE + 9; k++) {
		double p = 0;
		for (int c = 0; c < 3; c++)
			p += (v[k][c] - eye[c]) * along[c];
		area += fmin(1, fmax(0, p / (size + 1e-9)));
	}
	*at = (9.5 - area) * px;
	return sqrt(size);
}

/* Unit normal out of the opening at a column. */
static void normal_at(double n[2], const struct lid_curves *curves, int lower, int i, int first, int last,
                      const struct lid_chart *chart)
{
	int a = i > first ? i - 1 : i, b = i < last ? i + 1 : i;
	double slope = (curves->row[lower][b] - curves->row[lower][a]) / (b - a), t[2], side = lower ? 1 : -1;
	for (int k = 0; k < 2; k++)
		t[k] = chart->du[k] + slope * chart->dv[k];
	double length = hypot(t[0], t[1]);
	n[0] = -t[1] / length;
	n[1] = t[0] / length;
	if (side * (n[0] * chart->dv[0] + n[1] * chart->dv[1]) < 0)
		n[0] = -n[0], n[1] = -n[1];
}

static double column_step(double *rows, const struct lid_curves *curves, int lower, int i, int first, int last,
                          const struct lid_chart *chart, const struct lid_picture *picture,
                          const struct lid_margin_conf *conf)
{
	double n[2], p[2], v[SAMPLES][3], px = conf->reach / MIDDLE, at;
	normal_at(n, curves, lower, i, first, last, chart);
	lid_chart_px(p, chart, i, curves->row[lower][i]);
	for (int k = 0; k < SAMPLES; k++)
		lid_picture_at(v[k], picture, p[0] + (k - MIDDLE) * px * n[0], p[1] + (k - MIDDLE) * px * n[1]);
	double contrast = step_at(&at, v, px);
	double dv2 = chart->dv[0] * chart->dv[0] + chart->dv[1] * chart->dv[1];
	double up = (n[0] * chart->dv[0] + n[1] * chart->dv[1]) / dv2;  // rows a px along the normal
	*rows = at * up;
	return contrast;
}

double lid_margin_settle(struct lid_curves *curves, int lower, int first, int last, const struct lid_chart *chart,
                         const struct lid_picture *picture, const struct lid_margin_conf *conf)
{
	int n = last - first + 1;
	double *row = curves->row[lower] + first, y[LID_COLS_MAX], w[LID_COLS_MAX] = { 0 }, clear[LID_COLS_MAX];
	double out[LID_COLS_MAX], seen = 0;
	for (int i = 0; i < n; i++)
		w[i] = 1;
	lid_smooth(out, n, row, w, conf->bend);
	for (int i = 0; i < n; i++)
		row[i] = out[i];
	for (int round = 0; round < 3; round++) {
		seen = 0;
		for (int i = 0; i < n; i++) {
			double shift, contrast = column_step(&shift, curves, lower, first + i, first, last, chart, picture, conf);
			y[i] = row[i] + shift;
			clear[i] = contrast * contrast / (contrast * contrast + 400);
			seen += clear[i] / n;
			w[i] = clear[i];
		}
		for (int robust = 0; robust < 3; robust++) {
			lid_smooth(out, n, y, w, conf->bend);
			for (int i = 0; i < n; i++) {
				double u = (y[i] - out[i]) / 2.5;
				w[i] = clear[i] * (fabs(u) < 1 ? (1 - u * u) * (1 - u * u) : 0) + 1e-4;
			}
		}
		for (int i = 0; i < n; i++)
			row[i] = out[i];
	}
	double high = hypot(chart->dv[0], chart->dv[1]);
	for (int i = 0; i < n; i++) {
		double nrm[2];
		normal_at(nrm, curves, lower, first + i, first, last, chart);
		double cosine = fabs(nrm[0] * chart->dv[0] + nrm[1] * chart->dv[1]) / high;
		out[i] = row[i] + (lower ? 1 : -1) * conf->wet / high / fmax(0.3, cosine);
	}
	for (int i = 0; i < n; i++)
		row[i] = out[i];
	return seen;
}

bool lid_opening(int *first, int *last, const struct lid_curves *curves, int cols, double gap)
{
	int best = 0, from = -1;
	for (int i = 0; i <= cols; i++) {
		bool open = i < cols && curves->row[1][i] - curves->row[0][i] > gap;
		if (open && from < 0)
			from = i;
		if (!open && from >= 0) {
			if (i - from > best) {
				best = i - from;
				*first = from;
				*last = i - 1;
			}
			from = -1;
		}
	}
	return best >= 5;
}

void lid_points(double p[][2], int n, const struct lid_curves *curves, int lower, int first, int last,
                const double corner[2][2], const struct lid_chart *chart)
{
	double q[LID_COLS_MAX + 2][2], far[LID_COLS_MAX + 2];
	int m = 0;
	lid_chart_px(q[m++], chart, corner[0][0], corner[0][1]);
	for (int i = first; i <= last; i++)
		if (i > corner[0][0] && i < corner[1][0])
			lid_chart_px(q[m++], chart, i, curves->row[lower][i]);
	lid_chart_px(q[m++], chart, corner[1][0], corner[1][1]);
	far[0] = 0;
	for (int i = 1; i < m; i++)
		far[i] = far[i - 1] + hypot(q[i][0] - q[i - 1][0], q[i][1] - q[i - 1][1]);
	for (int k = 0, i = 0; k < n; k++) {
		double at = far[m - 1] * k / (n - 1);
		while (i < m - 2 && far[i + 1] < at)
			i++;
		double f = far[i + 1] > far[i] ? (at - far[i]) / (far[i + 1] - far[i]) : 0;
		for (int c = 0; c < 2; c++)
			p[k][c] = q[i][c] + fmin(1, f) * (q[i + 1][c] - q[i][c]);
	}
}
