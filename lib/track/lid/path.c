#include "track/lid/path.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "math/simd.h"

enum { STEEP = 5, ROUNDS = 3 };

struct ground {
	float sum[LID_ROWS + 1][LID_COLS_MAX];   // of the odds of the rows above
	float edge[LID_ROWS + 1][LID_COLS_MAX];  // 0..1 between row j - 1 and row j
	float cross[LID_ROWS + 1][LID_COLS_MAX]; // of the edges above that are no part of the iris
};

/* Weight of an edge as evidence against eye: none at the limbus, little inside it (pupil, reflections). */
static double strange(const double iris[4], int i, int j)
{
	double x = (i - iris[0]) / iris[2], y = (j - 0.5 - iris[1]) / iris[3], r2 = x * x + y * y;
	return !(r2 < 1.12 * 1.12) ? 1 : r2 > 0.88 * 0.88 ? 0 : 0.4;
}

static void survey(struct ground *ground, const struct lid_chart *chart, float odds[LID_ROWS][LID_COLS_MAX],
                   const double iris[4])
{
	for (int i = 0; i < chart->cols; i++) {
		ground->sum[0][i] = ground->cross[0][i] = 0;
		for (int j = 0; j < LID_ROWS; j++)
			ground->sum[j + 1][i] = ground->sum[j][i] + odds[j][i];
		for (int j = 0; j <= LID_ROWS; j++) {
			int a = j > 1 ? j - 2 : 0, b = j < LID_ROWS - 1 ? j + 1 : LID_ROWS - 1, d = 0;
			for (int c = 0; c < 3; c++)
				d += abs(chart->rgb[a][i][c] - chart->rgb[b][i][c]);
			// A difference of 25 in three channels is a full edge.
			ground->edge[j][i] = d > 75 ? 1 : (float)d / 75;
			// An edge shows in three rows.
			float e = ground->edge[j][i] > 0.3F ? ground->edge[j][i] / 3 * (float)strange(iris, i, j) : 0;
			if (j < LID_ROWS)
				ground->cross[j + 1][i] = ground->cross[j][i] + e;
		}
	}
}

struct margin {
	const struct ground *ground;
	const struct lid_match *match;
	const struct lid_path_conf *conf;
	const double *other, *expect;  // rows of the other margin; expected rows of this one
	int lower;
};

/* Cost of column i's margin between rows j - 1 and j; edge: row of the other one. */
static double cost_of(const struct margin *m, int i, int j, int edge, double sigma)
{
	const struct ground *ground = m->ground;
	const struct lid_path_conf *conf = m->conf;
	if (i < conf->columns[0] || i > conf->columns[1])
		return 2.0 * abs(j - edge);
	double off = (j - 0.5 - m->expect[i]) / sigma, cost = 0.5 * off * off, crossed = 0;
	// The margin's own edge is not counted.
	if (m->lower && j > edge + 2)
		crossed = ground->cross[j - 2][i] - ground->cross[edge][i];
	if (!m->lower && j < edge - 2)
		crossed = ground->cross[edge][i] - ground->cross[j + 3][i];
	double inside = (m->lower ? 1 : -1) * (ground->sum[j][i] - ground->sum[edge][i]);
	bool past = m->lower ? j < edge : j > edge;
	cost += conf->cross * crossed;
	cost += past ? 2.0 * abs(j - edge) : -conf->certain * inside - conf->edge * ground->edge[j][i];
	if (m->match->known) {
		bool asked = j >= m->match->first[m->lower] && j <= m->match->last[m->lower];
		cost += conf->strip * (asked ? m->match->cost[m->lower][j][i] / LID_STRIP_WORST : 1);
	}
	return cost;
}

/* Where a margin that steps by k rows costs less to come by than any before: best[j], step[j] of rows first..last. */
SIMD_CLONES static void come_by(float *restrict best, int *restrict step, const float *restrict before, float bend, int k, int first, int last)
{
	SIMD_LOOP
	for (int j = first; j <= last; j++) {
		const float c = before[j - k] + bend;
		step[j] = c < best[j] ? k : step[j];
		best[j] = c < best[j] ? c : best[j];
	}
}

/* One margin against the other, by dynamic programming. */
static void one_path(double path[], const struct margin *m, const struct lid_chart *chart)
{
	float cost[2][LID_ROWS + 1];
	signed char from[LID_COLS_MAX][LID_ROWS + 1];
	double a = lid_chart_corner(chart, 0), b = lid_chart_corner(chart, 1);
	int cols = chart->cols, end = 0;
	for (int i = 0; i < cols; i++) {
		float *now = cost[i & 1], *before = cost[!(i & 1)];
		// The corners of the eye move less than the middle.
		double t = (i - a) / (b - a), amid = t > 0 && t < 1 ? sqrt(4 * t * (1 - t)) : 0;
		double sigma = m->conf->sigma[m->lower] * (0.35 + 0.85 * amid), slope = i ? m->expect[i] - m->expect[i - 1] : 0;
		int lean = (int)lround(fmax(-100, fmin(100, slope))), edge = (int)fmin(LID_ROWS, fmax(0, m->other[i]));
		float best[LID_ROWS + 1];
		int step[LID_ROWS + 1];
		for (int j = 0; j <= LID_ROWS; j++) {
			best[j] = i ? 1e9F : 0;
			step[j] = 0;
		}
		for (int k = lean - STEEP; i && k <= lean + STEEP; k++)
			come_by(best, step, before, (float)(m->conf->bend * (k - slope) * (k - slope)), k, k > 0 ? k : 0, k < 0 ? LID_ROWS + k : LID_ROWS);
		for (int j = 0; j <= LID_ROWS; j++) {
			now[j] = best[j] + (float)cost_of(m, i, j, edge, sigma);
			from[i][j] = (signed char)step[j];
			end = i == cols - 1 && now[j] < now[end] ? j : end;
		}
	}
	for (int i = cols - 1, j = end; i >= 0; i--) {
		path[i] = j - 0.5;
		j -= from[i][j];
		j = j < 0 ? 0 : j > LID_ROWS ? LID_ROWS : j;
	}
}

double lid_path(struct lid_curves *out, const struct lid_chart *chart, float odds[LID_ROWS][LID_COLS_MAX],
                const struct lid_match *match, const struct lid_curves *expect, const struct lid_path_conf *conf)
{
	struct ground ground;
	survey(&ground, chart, odds, conf->iris);
	double mid[LID_COLS_MAX];
	for (int i = 0; i < chart->cols; i++)
		mid[i] = expect->row[1][i] + 0.5;
	for (int k = 0; k < ROUNDS; k++) {
		double other[LID_COLS_MAX];
		one_path(out->row[0], &(struct margin){ &ground, match, conf, mid, expect->row[0], 0 }, chart);
		for (int i = 0; i < chart->cols; i++)
			other[i] = out->row[0][i] + 0.5;
		one_path(out->row[1], &(struct margin){ &ground, match, conf, other, expect->row[1], 1 }, chart);
		bool same = true;
		for (int i = 0; i < chart->cols; i++) {
			same &= fabs(mid[i] - out->row[1][i] - 0.5) < 1.5;
			mid[i] = out->row[1][i] + 0.5;
		}
		if (same)
			break;
	}
	double in = 0, rim = 0;
	int n_in = 0, n_rim = 0;
	for (int i = 0; i < chart->cols; i++) {
		int u = (int)(out->row[0][i] + 0.5), l = (int)(out->row[1][i] + 0.5);
		if (l <= u)
			continue;
		in += ground.sum[l][i] - ground.sum[u][i];
		n_in += l - u;
		int a = u > 6 ? u - 6 : 0, b = l < LID_ROWS - 6 ? l + 6 : LID_ROWS;
		rim += ground.sum[u][i] - ground.sum[a][i] + ground.sum[b][i] - ground.sum[l][i];
		n_rim += u - a + b - l;
	}
	return n_in && n_rim ? in / n_in - rim / n_rim : 0;
}

double lid_path_refine(double row[], const struct lid_match *match, int lower, int first, int last, double bend)
{
	double y[LID_COLS_MAX], w[LID_COLS_MAX], out[LID_COLS_MAX] = { 0 }, sum = 0;
	int n = last - first + 1;
	for (int i = 0; i < n; i++) {
		int j = (int)lround(row[first + i] + 0.5);
		y[i] = row[first + i];
		w[i] = 1e-3;
		if (j <= match->first[lower] || j >= match->last[lower])
			continue;
		double a = match->cost[lower][j - 1][first + i], b = match->cost[lower][j][first + i];
		double c = match->cost[lower][j + 1][first + i], curve = a - 2 * b + c;
		sum += b / n;
		if (curve > 1e-6)
			y[i] += fmin(1, fmax(-1, 0.5 * (a - c) / curve));
		w[i] += fmax(0, curve);
	}
	for (int round = 0; round < 3; round++) {
		double v[LID_COLS_MAX] = { 0 };
		for (int i = 0; i < n; i++) {
			double u = round ? (y[i] - out[i]) / 2.5 : 0;
			v[i] = w[i] * (fabs(u) < 1 ? (1 - u * u) * (1 - u * u) : 0) + 1e-4;
		}
		lid_smooth(out, n, y, v, bend);
	}
	for (int i = 0; i < n; i++)
		row[first + i] = out[i];
	return sum;
}

void lid_smooth(double out[], int n, const double y[], const double w[], double bend)
{
	// Pentadiagonal LDL' factorisation: one pass down, one up.
	double d[LID_COLS_MAX], e[LID_COLS_MAX], f[LID_COLS_MAX], z[LID_COLS_MAX];
	for (int i = 0; i < n; i++) {
		int a = i < n - 2, b = i >= 1 && i < n - 1, c = i >= 2;
		d[i] = w[i] + bend * (a + 4 * b + c) + 1e-9;
		e[i] = -2 * bend * (b + (i < n - 2));
		f[i] = i < n - 2 ? bend : 0;
		e[i] = i < n - 1 ? e[i] : 0;
		z[i] = w[i] * y[i];
	}
	for (int i = 0; i < n; i++) {
		if (i + 1 < n) {
			double m = e[i] / d[i];
			d[i + 1] -= m * e[i];
			z[i + 1] -= m * z[i];
			if (i + 2 < n) {
				e[i + 1] -= m * f[i];
				double q = f[i] / d[i];
				d[i + 2] -= q * f[i];
				z[i + 2] -= q * z[i];
			}
		}
	}
	for (int i = n - 1; i >= 0; i--) {
		out[i] = z[i];
		if (i + 1 < n)
			out[i] -= e[i] * out[i + 1];
		if (i + 2 < n)
			out[i] -= f[i] * out[i + 2];
		out[i] /= d[i];
	}
}
