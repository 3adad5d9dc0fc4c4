/* Brows. */
#include <math.h>
#include <stdlib.h>

#include "base/mem.h"
#include "math/stats.h"
#include "math/vec.h"
#include "rig/hair/impl.h"

/* The middle of a brow by the share s of its length from the nose: units outward of and above the eyeball's centre. Assumption, of an average
 * adult: it begins above the inner corner of the eye, is highest two thirds of its way out, some 20 mm above the pupil, and ends beyond the outer
 * corner; the character's own ridge moves it up or down. */
static const double inner = -15.5, outer = 22;
static double middle(double s) { return 16.2 + 12.4 * s - 12.6 * s * s; }
static double half_breadth(double s) { return s < 0.12 ? 2 + 8 * s : 3 * (1 - 0.72 * fmin(fmax((s - 0.4) / 0.6, 0), 1)); }

/* How far above the average the character's own ridge lies: where, column by column, skin stands out most over the line from lid to forehead. */
static double ridge(const struct front *f)
{
	enum { PLACES = 15, STEPS = 31 };
	double off[PLACES];
	int n = 0;
	for (int i = 0; i < PLACES; i++) {
		const double s = 0.2 + 0.6 * i / (PLACES - 1), x = inner + s * (outer - inner), low = middle(s) - 7, step = 0.5;
		struct front_hit a, b, hit;
		double most = 0, at = NAN;
		if (!front_skin(&a, f, x, low) || !front_skin(&b, f, x, low + step * (STEPS - 1)))
			continue;
		for (int k = 1; k < STEPS - 1; k++) {
			if (!front_skin(&hit, f, x, low + step * k))
				continue;
			const double over = hit.z - a.z - (b.z - a.z) * k / (STEPS - 1);
			if (over > most) {
				most = over;
				at = low + step * k;
			}
		}
		if (isfinite(at))
			off[n++] = at - middle(s);
	}
	return n > PLACES / 2 ? fmin(fmax(stats_median(n, off), -4), 4) : 0;
}

/* Direction of growth in its middle, radians from outward towards up: upright at the nose, along the brow further out. */
static double along(double s) { return s < 0.3 ? 1.25 - 2.6 * s : 0.47 - 1.25 * (s - 0.3); }
double hair_brow_way(double x) { return along(fmin(fmax((x - inner) / (outer - inner), 0), 1)); }

/* Rows above and below lean to its middle. */
static double way(double s, double row)
{
	return along(s) - 0.35 * row * fmin(1, 0.3 + 2 * s);
}

/* A hair rooted at (x, y), combed along the skin. */
static void comb(struct hairs *h, const struct front *f, double x, double y, double angle, double length, double half, struct rng *rng)
{
	const double bend = rng_range(rng, -0.25, -0.05), stand = rng_range(rng, 0.25, 0.6);
	double point[HAIR_BROW_POINTS][3];
	struct front_hit root, hit;
	if (!front_skin(&root, f, x, y) || root.normal[2] < 0.15)
		return;
	for (int k = 0; k < HAIR_BROW_POINTS; k++) {
		const double t = (double)k / (HAIR_BROW_POINTS - 1), a = angle + bend * t, part = length / (HAIR_BROW_POINTS - 1);
		if (!front_skin(&hit, f, x, y))
			return;
		const double up = k ? stand * sin(M_PI * (0.15 + 0.7 * t)) : -0.1;
		vec_add(point[k], (double[]){ x, y, hit.z }, up, hit.normal);
		// As far on the skin as the hair is long, however it slopes away from the front.
		const double slope = (hit.normal[0] * cos(a) + hit.normal[1] * sin(a)) / fmax(hit.normal[2], 0.3);
		x += part * cos(a) / sqrt(1 + slope * slope);
		y += part * sin(a) / sqrt(1 + slope * slope);
	}
	front_add(h, f, &root, HAIR_BROW, HAIR_BROW_POINTS, (const double(*)[3])point, half);
}

static void average(struct hairs *h, const struct front *f, const struct hair_conf *conf, struct rng *rng)
{
	const double lift = ridge(f);
	for (int i = 0; i < conf->brow_hairs; i++) {
		const double s = pow((i + rng_uniform(rng)) / conf->brow_hairs, 1.12), row = 0.5 * fmin(fmax(rng_normal(rng), -2.2), 2.2);
		const double angle = way(s, row) + 0.13 * rng_normal(rng);
		const double length = conf->brow_mm * (0.5 + 0.5 * sin(M_PI * fmin(fmax(s, 0.02), 0.85))) * rng_range(rng, 0.7, 1.05);
		// Its ends are not cut: hairs there are scattered further.
		const double astray = 0.5 + 1.2 * exp(-s / 0.08) + 0.8 * exp((s - 1) / 0.08);
		const double x = inner + s * (outer - inner) + astray * fmin(fmax(rng_normal(rng), -2), 2);
		comb(h, f, x, middle(s) + lift + row * half_breadth(s), angle, length, rng_range(rng, 0.03, 0.045), rng);
	}
}

/* The cell of the person's brow that lies where the front of the character shows its skin; -1: none. */
static int cell_at(const struct front *f, const struct hair_conf *conf, double x, double y)
{
	struct front_hit hit;
	double at[3] = { 0 };
	if (!front_skin(&hit, f, x, y) || hit.normal[2] < 0.15)
		return -1;
	for (int k = 0; k < 3; k++) {
		const int v = f->rig->faces[hit.face][k];
		if (v >= rig_own_vertices(f->rig))
			return -1;
		for (int c = 0; c < 3; c++)
			at[c] += (double)(hit.weight[k] * conf->place[v][c]);
	}
	return hair_cell(conf->film, f->side, at);
}

/* As many hairs as hide as much of the skin, cell by cell, as the film shows. */
static void filmed(struct hairs *h, const struct front *f, const struct hair_conf *conf, struct rng *rng)
{
	enum { CELLS = HAIR_CELLS_X * HAIR_CELLS_Y, MOST = 5000 };
	const float *cover = &conf->film->cover[f->side][0][0], *way = &conf->film->way[f->side][0][0];
	const double longest = 0.8 * conf->brow_mm, mean = 0.8 * longest, hides = 1.15 * 0.028 * mean;  // mm; mm2 of a hair in the mean
	double *sum = mem_new(CELLS + 1, sizeof *sum);
	int *cell = mem_new(CELLS, sizeof *cell);
	for (int i = 0; i < CELLS; i++) {
		const double x = HAIR_FROM_X + HAIR_CELL * (i % HAIR_CELLS_X), y = HAIR_FROM_Y + HAIR_CELL * (double)(i / HAIR_CELLS_X);
		cell[i] = cell_at(f, conf, x, y);
		// Hairs lie over each other: of a share c of the skin that is hidden -ln(1 - c) is their area.
		sum[i + 1] = sum[i] - (cell[i] < 0 ? 0 : HAIR_CELL * HAIR_CELL * log1p(-fmin((double)cover[cell[i]], 0.9)));
	}
	const int n = (int)fmin(sum[CELLS] / hides, MOST);
	for (int k = 0, i = 0; k < n; k++) {
		const double at = (k + rng_uniform(rng)) / n * sum[CELLS];
		while (i + 1 < CELLS && sum[i + 1] < at)
			i++;
		while (i > 0 && sum[i] > at)
			i--;
		const double angle = (double)way[cell[i]] + 0.1 * rng_normal(rng), length = longest * rng_range(rng, 0.6, 1);
		const double x = HAIR_FROM_X + HAIR_CELL * (i % HAIR_CELLS_X + rng_uniform(rng) - 0.5), y = HAIR_FROM_Y + HAIR_CELL * (i / HAIR_CELLS_X + rng_uniform(rng) - 0.5);
		comb(h, f, x - 0.5 * length * cos(angle), y - 0.5 * length * sin(angle), angle, length, rng_range(rng, 0.022, 0.034), rng);  // its middle is where it hides
	}
	free(sum);
	free(cell);
}

void hairs_grow_brow(struct hairs *h, const struct front *f, const struct hair_conf *conf, struct rng *rng)
{
	if (!(conf->brow_mm > 0))
		return;
	if (conf->film && conf->film->brow[f->side])
		filmed(h, f, conf, rng);
	else
		average(h, f, conf, rng);
}
