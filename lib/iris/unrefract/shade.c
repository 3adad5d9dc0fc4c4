#include "iris/unrefract/shade.h"

#include <math.h>
#include <stdlib.h>

#include "base/mem.h"
#include "iris/unrefract/register.h"
#include "math/stats.h"

enum { ANGLES = SHEET_ANGLES, RINGS = SHEET_RINGS, CELLS = ANGLES * RINGS, LIDS = 4, REACHES = 6 };

static const double inner = 0.1, outer = 0.94;       // t: the pupil's and the limbus' blur
static const double close = 0.1;                     // mm: so near to a lid it is its blur and its lashes
static const double patch = 0.8;                     // mm: what lies farther apart in an iris is another part of its pattern
static const double sure = 4;                        // log likelihood that shade must gain
static const double least = 0.1, most = 1.8;         // amplitudes, log
static const double restless = 0.75;                 // log: an iris that varies so much round its rings is not told from what it mirrors
static const double dark = 0.8, darkest = 1.3;       // log: from which what is left of the light is too little to tell colours

struct cell {
	double p[2], d, along, area, log[3];  // mm; to the nearest lid's edge, mm; -1 .. 1 along that lid; mm^2
	int lid;                              // -1: none
	bool seen;
};

struct lid { int first, n; };             // angles
struct lid_fit { double reach, a[2], ratio[3]; };  // mm; log of the green's amplitude in the lid's middle, its slope; each channel's over the green's

static int lids_of(struct lid lid[LIDS], const double lid_t[ANGLES])
{
	int start = 0, n = 0;
	while (start < ANGLES && lid_t[start] < 1)
		start++;
	for (int i = 0; i < ANGLES && start < ANGLES && n < LIDS; i++) {
		int k = 0;
		while (k < ANGLES && lid_t[(start + i + k) % ANGLES] < 1)
			k++;
		if (k)
			lid[n++] = (struct lid){ (start + i) % ANGLES, k };
		i += k;
	}
	return n;
}

static void measure_cell(struct cell *cell, const double (*edge)[2], int n, const struct lid lid[])
{
	cell->lid = -1;
	cell->d = INFINITY;
	for (int k = 0; k < n; k++)
		for (int i = 0; i < lid[k].n; i++) {
			const int a = (lid[k].first + i) % ANGLES;
			const double d = hypot(cell->p[0] - edge[a][0], cell->p[1] - edge[a][1]);
			if (d < cell->d) {
				cell->d = d;
				cell->lid = k;
				cell->along = 2 * (i + 0.5) / lid[k].n - 1;
			}
		}
}

static struct cell *cells_of(const float *const logs[3], const double lid_t[ANGLES], const float *iris, const struct sheet *sheet, int n, const struct lid lid[])
{
	struct cell *cell = mem_new(CELLS, sizeof *cell);
	double(*edge)[2] = mem_array(ANGLES, sizeof *edge);
	for (int a = 0; a < ANGLES; a++)
		sheet_point(edge[a], sheet, lid_t[a], 2 * M_PI * (a + 0.5) / ANGLES);
#pragma omp parallel for schedule(static)
	for (int i = 0; i < CELLS; i++) {
		const double t = (i % RINGS + 0.5) / RINGS, step = 2 * M_PI / ANGLES;
		double next[2], out[2];
		struct cell *c = &cell[i];
		sheet_point(c->p, sheet, t, step * (i / RINGS + 0.5));
		sheet_point(next, sheet, t, step * (i / RINGS + 1.5));
		sheet_point(out, sheet, t + 1.0 / RINGS, step * (i / RINGS + 0.5));
		c->area = hypot(next[0] - c->p[0], next[1] - c->p[1]) * hypot(out[0] - c->p[0], out[1] - c->p[1]);
		c->seen = t > inner && t < outer && sheet_sample(iris, sheet, c->p) > 0.9f;
		for (int k = 0; k < 3; k++)
			c->log[k] = sheet_sample(logs[k], sheet, c->p);
		measure_cell(c, edge, n, lid);
	}
	free(edge);
	return cell;
}

/* Takes each ring's level off, as it is far from lids; where a ring is seen nowhere far from them, as it is the farthest from them. */
static void level(struct cell cell[CELLS], double reach)
{
	double *x = mem_array(ANGLES, sizeof *x), ring[RINGS][3];
	bool known[RINGS];
	for (int r = 0; r < RINGS; r++) {
		double far = reach;
		int n = 0;
		for (; far > close && n < ANGLES / 12; far -= reach / 8) {
			n = 0;
			for (int a = 0; a < ANGLES; a++)
				n += cell[a * RINGS + r].seen && cell[a * RINGS + r].d > far;
		}
		known[r] = n >= ANGLES / 12;
		for (int k = 0; k < 3 && known[r]; k++) {
			n = 0;
			for (int a = 0; a < ANGLES; a++)
				if (cell[a * RINGS + r].seen && cell[a * RINGS + r].d > far + reach / 8)
					x[n++] = cell[a * RINGS + r].log[k];
			ring[r][k] = stats_median(n, x);
		}
	}
	for (int i = 0; i < CELLS; i++) {
		cell[i].seen = cell[i].seen && known[i % RINGS];
		for (int k = 0; k < 3; k++)
			cell[i].log[k] -= known[i % RINGS] ? ring[i % RINGS][k] : 0;
	}
	free(x);
}

static double fall(double d, double reach)
{
	return d < reach ? (1 - d / reach) * (1 - d / reach) : 0;
}

/* Robust spread of the green among what is far from lids. */
static double spread_of(const struct cell cell[CELLS], double reach)
{
	double *x = mem_array(CELLS, sizeof *x), spread = 0.1;
	int n = 0;
	for (int i = 0; i < CELLS; i++)
		if (cell[i].seen && cell[i].d > 0.5 * reach)
			x[n++] = fabs(cell[i].log[1]);
	if (n > CELLS / 50)
		spread = fmax(1.48 * stats_median(n, x), 0.03);
	free(x);
	return spread;
}

/* Cauchy's log likelihood, of patches that are another part of the pattern each. */
static double cost_of(const struct cell *c, double residual, double spread)
{
	return -log1p(residual * residual / (2 * spread * spread)) * c->area / (patch * patch);
}

/* Amplitude of one channel along a lid: least squares with Cauchy's weights; the slope is held to little. Returns the gain in log likelihood. */
static double fit_lid(double a[2], int n, const struct cell cell[], int channel, double reach, double spread)
{
	double gain = 0;
	a[0] = a[1] = 0;
	const int passes = 8;
	for (int pass = 0; pass < passes; pass++) {
		double m[2][2] = { { 1e-6, 0 }, { 0, 1 / (0.3 * 0.3) } }, b[2] = { 0, 0 };
		for (int i = 0; i < n; i++) {
			const struct cell *c = &cell[i];
			const double f = fall(c->d, reach), g[2] = { f, f * c->along }, r = c->log[channel] + a[0] * g[0] + a[1] * g[1];
			const double w = c->area / (patch * patch) / (spread * spread) / (1 + r * r / (2 * spread * spread));
			for (int j = 0; j < 2; j++) {
				b[j] -= w * g[j] * c->log[channel];
				for (int k = 0; k < 2; k++)
					m[j][k] += w * g[j] * g[k];
			}
			if (pass == passes - 1)
				gain += cost_of(c, r, spread) - cost_of(c, c->log[channel], spread);
		}
		const double det = m[0][0] * m[1][1] - m[0][1] * m[1][0];
		a[0] = (b[0] * m[1][1] - b[1] * m[0][1]) / det;
		a[1] = (m[0][0] * b[1] - m[1][0] * b[0]) / det;
	}
	return gain;
}

/* False: no shade is seen below that lid. */
static bool shade_of(struct lid_fit *fit, const struct cell cell[CELLS], int lid, double most_reach, double spread)
{
	double best = sure, a[2];
	int n = 0;
	struct cell *near = mem_array(CELLS, sizeof *near);
	*fit = (struct lid_fit){ 0 };
	for (int i = 0; i < CELLS; i++)
		if (cell[i].seen && cell[i].lid == lid && cell[i].d >= close && cell[i].d <= most_reach)
			near[n++] = cell[i];
	for (int i = 0; i < REACHES; i++) {
		const double reach = most_reach * pow(0.7, i), gain = fit_lid(a, n, near, 1, reach, spread);
		if (gain > best && a[0] > least) {
			best = gain;
			*fit = (struct lid_fit){ .reach = reach, .a = { fmin(a[0], most), a[1] } };
		}
	}
	for (int k = 0; k < 3 && fit->reach > 0; k++) {
		fit_lid(a, n, near, k, fit->reach, spread);
		fit->ratio[k] = fmin(fmax(a[0] / fit->a[0], 0.5), 2);
	}
	free(near);
	return fit->reach > 0;
}

/* The shade at a cell, log of what is left; three channels. */
static void shade_at(double out[3], const struct cell *c, const struct lid_fit fit[])
{
	out[0] = out[1] = out[2] = 0;
	if (c->lid < 0 || !(fit[c->lid].reach > 0))
		return;
	const struct lid_fit *f = &fit[c->lid];
	const double amplitude = fmax(f->a[0] + f->a[1] * c->along, 0) * fall(c->d, f->reach);
	for (int k = 0; k < 3; k++)
		out[k] = -amplitude * f->ratio[k];
}

/* Writes the shade of each texel, between the four cells about it, and takes it off the survey. */
static void apply(struct unrefract_survey *survey, const float *t, const struct cell cell[CELLS], const struct lid_fit fit[], const struct sheet *sheet)
{
	const int size = survey->size;
	const long n = (long)size * size;
	double(*shade)[3] = mem_array(CELLS, sizeof *shade);
	for (int i = 0; i < CELLS; i++)
		shade_at(shade[i], &cell[i], fit);
	survey->shade = mem_new((size_t)(3 * n), sizeof *survey->shade);
	double sum = 0, taken = 0;
#pragma omp parallel for schedule(static)
	for (long i = 0; i < n; i++) {
		if (!(t[i] > 0 && t[i] < 1))
			continue;
		const double mm = 2 * survey->extent / size, x = (double)(i % size) * mm + mm / 2 - survey->extent, y = (double)(i / size) * mm + mm / 2 - survey->extent;
		const double phi = atan2(y - sheet->pupil.cy, x - sheet->pupil.cx), u = (phi / (2 * M_PI) + 1) * ANGLES - 0.5, v = fmin(fmax((double)t[i] * RINGS - 0.5, 0), RINGS - 1.001);
		const int a = (int)u, r = (int)v;
		const double fa = u - a, fr = v - r;
		for (int k = 0; k < 3; k++) {
			const double low = (1 - fa) * shade[a % ANGLES * RINGS + r][k] + fa * shade[(a + 1) % ANGLES * RINGS + r][k];
			const double high = (1 - fa) * shade[a % ANGLES * RINGS + r + 1][k] + fa * shade[(a + 1) % ANGLES * RINGS + r + 1][k];
			survey->shade[k * n + i] = (float)((1 - fr) * low + fr * high);
			survey->rgb[3 * i + k] *= expf(-survey->shade[k * n + i]);
		}
		survey->weight[i] *= (float)fmin(fmax((darkest + (double)survey->shade[n + i]) / (darkest - dark), 0), 1);
	}
	for (long i = 0; i < n; i++) {
		sum += (double)survey->weight[i];
		taken += (double)survey->weight[i] * (1 - exp((double)survey->shade[n + i]));
	}
	survey->lid_shade = sum > 0 ? taken / sum : 0;
	free(shade);
}

void unrefract_shade(struct unrefract_survey *survey, const float *const logs[3], const float *t, const double lid_t[ANGLES], const float *iris,
                     const struct sheet *sheet, const struct unrefract_conf *conf)
{
	struct lid lid[LIDS];
	struct lid_fit fit[LIDS];
	const int n = lids_of(lid, lid_t);
	bool any = false;
	if (!n || !(conf->lid_shade > 0))
		return;
	struct cell *cell = cells_of(logs, lid_t, iris, sheet, n, lid);
	level(cell, conf->lid_shade);
	const double spread = spread_of(cell, conf->lid_shade);
	for (int k = 0; k < n && spread < restless; k++)
		any |= shade_of(&fit[k], cell, k, conf->lid_shade, spread);
	if (any)
		apply(survey, t, cell, fit, sheet);
	free(cell);
}

void unrefract_unshade(float rgb[3], const struct unrefract_survey *s, const double p[2])
{
	const long n = (long)s->size * s->size;
	for (int k = 0; k < 3 && s->shade; k++)
		rgb[k] *= expf(-survey_at(s, s->shade + k * n, p));
}
