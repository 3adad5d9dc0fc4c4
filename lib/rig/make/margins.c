/* Margins as arcs. What is learnt of a margin, point by point, waves by a millimetre, and the character's corners are not quite the
 * subject's. Here the margins' motion is fitted by few functions of the place along the fissure. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "math/chol.h"
#include "math/vec.h"
#include "rig/make/make_impl.h"

enum { UPPER, LOWER, LIDS, TERMS = 2 + LIDS };

static const double gap_fade = 2;       // mm to either side of the gap up to which skin is a lid
static const double open_mm = 0.3;      // less than this is a corner
static const double margin_mm = 1;      // as far from the line, skin goes with its own column
static const double inwards[] = { -0.6, -0.2 };  // cosine of a normal with the way off the eyeball: up to the first skin lines a lid
static const double least_mm[] = { 10, 2 };  // length and height of what is an eye's opening

/* The character's opening at rest, in columns of the modelling camera. */
struct opening {
	int n;
	double first, px_per_mm, most;  // most: the largest opening, px
	double scale, end[2];           // px for a mm of an eyeball of 12 mm; columns between which the eyeball is seen
	double *y[LIDS], *height;  // of the margins, px; opening, of its largest
	double *sum;               // [n + 1] of the heights of the columns before
};

static void opening_free(struct opening *o)
{
	free(o->y[UPPER]);
	free(o->y[LOWER]);
	free(o->height);
	free(o->sum);
}

/* Means over half a millimetre to each side: margins of coarse meshes have corners. */
static double smoothed(const float *y, int at, int from, int to, int reach)
{
	double sum = 0;
	int k = at - from < to - at ? at - from : to - at, n = k < reach ? k : reach;
	for (int i = at - n; i <= at + n; i++)
		sum += y[i];
	return sum / (2 * n + 1);
}

/* Margins run straight from column `from` to a corner at `corner`, whose height is that of the eyeball's end at column `end`. */
static void to_corner(struct opening *o, int corner, int end, int from)
{
	const double y = 0.5 * (o->y[UPPER][end] + o->y[LOWER][end]);
	for (int lid = 0; lid < LIDS && from != corner; lid++) {
		const double y0 = o->y[lid][from];
		for (int i = from; i != corner; i += corner > from ? 1 : -1)
			o->y[lid][i] = y0 + (y - y0) * (i - from) / (corner - from);
		o->y[lid][corner] = y;
	}
}

static void take_height(struct opening *o)
{
	o->most = 1e-6;
	for (int i = 0; i < o->n; i++)
		o->most = fmax(o->most, o->height[i] = o->y[LOWER][i] - o->y[UPPER][i]);
	for (int i = 0; i < o->n; i++) {
		o->height[i] /= o->most;
		o->sum[i + 1] = o->sum[i] + o->height[i];
	}
}

/* False: there is none. */
static bool opening_of(struct opening *o, const struct rig *rig, const struct rig_motion *m, int side, double px_per_mm,
                       const struct rig_conf *conf)
{
	struct rig_fissure f;
	const double still[RIG_COMPONENTS] = { 0 };
	if (!rig_fissure_new(&f, rig, m, side, (double[]){ 6 * px_per_mm, 3 * px_per_mm }))
		return false;
	rig_fissure_look(&f, rig, side, still);
	int best = 0, from, to;
	for (int x = 0; x < f.width; x++)
		if (f.bottom[x] - f.top[x] > f.bottom[best] - f.top[best])
			best = x;
	for (from = best; from > 0 && f.bottom[from - 1] - f.top[from - 1] > open_mm * px_per_mm; from--)
		;
	for (to = best; to + 1 < f.width && f.bottom[to + 1] - f.top[to + 1] > open_mm * px_per_mm; to++)
		;
	bool ok = to - from > least_mm[0] * px_per_mm && f.bottom[best] - f.top[best] > least_mm[1] * px_per_mm;
	// At most twice a person's: both ends then stay within the shortest opening, whatever size a character has.
	const double scale = px_per_mm * fmin(rig->globe[side].radius / 12, 2);
	const int left_end = side;  // the inner corner of the left eye, the outer one of the right
	const int left = (int)(conf->beyond[left_end] * scale), right = (int)(conf->beyond[!left_end] * scale);
	*o = (struct opening){ .n = ok ? left + to - from + 1 + right : 0, .first = f.x0 + from - left, .px_per_mm = px_per_mm, .scale = scale, .end = { left, left + to - from } };
	for (int lid = 0; lid < LIDS; lid++)
		o->y[lid] = mem_new((size_t)o->n + 1, sizeof *o->y[lid]);
	o->sum = mem_new((size_t)o->n + 1, sizeof *o->sum);
	o->height = mem_new((size_t)o->n + 1, sizeof *o->height);
	for (int x = from; x <= to && ok; x++) {
		o->y[UPPER][left + x - from] = smoothed(f.top, x, from, to, (int)(0.5 * px_per_mm));
		o->y[LOWER][left + x - from] = smoothed(f.bottom, x, from, to, (int)(0.5 * px_per_mm));
	}
	if (ok) {
		to_corner(o, 0, left, left + (int)(conf->within[left_end] * scale));
		to_corner(o, o->n - 1, o->n - 1 - right, o->n - 1 - right - (int)(conf->within[!left_end] * scale));
		take_height(o);
	}
	rig_fissure_free(&f);
	if (!ok)
		opening_free(o);
	return ok;
}

/* Mean height of the columns from `from` up to `to`, px; beyond the corners it is 0. */
static double height_over(const struct opening *o, double from, double to)
{
	const double a = fmin(fmax(from - o->first, 0), o->n), b = fmin(fmax(to - o->first, 0), o->n);
	const int i = (int)fmin(a, o->n - 1), j = (int)fmin(b, o->n - 1);
	return (o->sum[j] + (b - j) * o->height[j] - o->sum[i] - (a - i) * o->height[i]) / (to - from);
}

/* The functions of the place: how much of each corner's motion, and of each lid's. x: px; beyond the corners theirs. spread: px to
 * either side over which skin that far from the margin takes the mean, so that what shuts steeply at a corner tears no skin above it. */
static void terms_at(double out[TERMS], const struct opening *o, int lid, double x, double spread)
{
	double t = fmin(fmax((x - o->first) / (o->n - 1), 0), 1);
	out[0] = 1 - t;
	out[1] = t;
	out[2 + lid] = height_over(o, x - spread, x + spread);
	out[2 + !lid] = 0;
}

static double margin_weight(const struct opening *o, int lid, const float at[2])
{
	double x = fmin(fmax(at[0], o->first), o->first + o->n - 1), y = o->y[lid][(int)(x - o->first)];
	double d = hypot(at[0] - x, at[1] - y) / o->px_per_mm;
	return exp(-0.5 * d * d / (0.8 * 0.8));
}

/* Least squares over the skin near the margins: coefficient[TERMS][RIG_BASIS], out. */
static bool fit(double coefficient[TERMS][RIG_BASIS], const struct opening *o, const struct rig *rig, int side, double lid_gap)
{
	double A[TERMS][TERMS] = { 0 };
	bool ok = true;
	memset(coefficient, 0, TERMS * sizeof *coefficient);
	for (int i = 0; i < rig->n; i++) {
		if (rig->part[i] != RIG_SKIN || rig->side[i] != side || rig->gap[i] * o->px_per_mm / o->scale > lid_gap || rig->gap[i] < -2)
			continue;
		double w[LIDS] = { margin_weight(o, UPPER, rig->home[i]), margin_weight(o, LOWER, rig->home[i]) };
		for (int lid = 0; lid < LIDS; lid++) {
			double g[TERMS], own = w[lid] > w[!lid] ? w[lid] : 0;
			terms_at(g, o, lid, rig->home[i][0], 0.5);
			for (int j = 0; j < TERMS && own > 1e-4; j++) {
				for (int k = 0; k < TERMS; k++)
					A[j][k] += own * g[j] * g[k];
				for (int k = 0; k < RIG_BASIS; k++)
					coefficient[j][k] += own * g[j] * rig->basis[i][k];
			}
		}
	}
	for (int k = 0; k < RIG_BASIS && ok; k++) {
		double M[TERMS][TERMS], x[TERMS];
		memcpy(M, A, sizeof M);
		for (int j = 0; j < TERMS; j++) {
			M[j][j] += 1e-6;
			x[j] = coefficient[j][k];
		}
		ok = chol_solve(TERMS, TERMS, &M[0][0], x);
		for (int j = 0; j < TERMS; j++)
			coefficient[j][k] = x[j];
	}
	return ok;
}

/* Makes the upper margin come down, in proportion to how far eyes are closed, by what the closed pose leaves open; returns that, px. */
static double shut(double coefficient[TERMS][RIG_BASIS], const struct opening *o, const double closed[RIG_COMPONENTS],
                 const double closing[RIG_COMPONENTS], double seal_mm)
{
	double lack = o->most + seal_mm * o->px_per_mm;
	for (int k = 0; k < RIG_COMPONENTS; k++)
		lack -= (coefficient[2 + UPPER][RIG_COMPONENTS + k] - coefficient[2 + LOWER][RIG_COMPONENTS + k]) * closed[k];
	for (int k = 0; k < RIG_COMPONENTS; k++)
		coefficient[2 + UPPER][RIG_COMPONENTS + k] += lack * closing[k];
	return lack;
}

static double fading(double x, double from, double to)
{
	double t = fmin(fmax((x - from) / (to - from), 0), 1);
	return 1 - t * t * (3 - 2 * t);
}

/* Share of a vertex in a lid's outside: what lines it faces the eyeball. */
static double outside(const struct rig *rig, int i)
{
	const double *center = rig->globe[rig->side[i]].center;
	double away[3], normal[3];
	for (int c = 0; c < 3; c++) {
		away[c] = rig->rest[i][c] - center[c];
		normal[c] = rig->normal[i][c];
	}
	return 1 - fading(vec_dot(away, normal) / fmax(vec_norm(away), 1e-6), inwards[0], inwards[1]);
}

/* How far off the eyeball the outside of a lid is at its margin, mm: the mean over its skin there. 0: there is none. */
static double outside_gap(const struct opening *o, const struct rig *rig, int side, int lid, double lid_gap)
{
	double sum = 0, total = 0;
	for (int i = 0; i < rig->n; i++) {
		if (rig->part[i] != RIG_SKIN || rig->side[i] != side || rig->gap[i] * o->px_per_mm / o->scale > lid_gap)
			continue;
		const double w = outside(rig, i) * margin_weight(o, lid, rig->home[i]);
		sum += w * fmax((double)rig->gap[i], 0);
		total += w;
	}
	return total > 1e-3 ? sum / total : 0;
}

/* A lid turns about the eyeball's centre as one, so that what is nearer to it goes less far than its outside: else what lines it comes before the margin. */
static double nearer_in(const struct rig *rig, int i, double gap)
{
	const struct rig_globe *globe = &rig->globe[rig->side[i]];
	double away[3];
	for (int c = 0; c < 3; c++)
		away[c] = rig->rest[i][c] - globe->center[c];
	return fmin(vec_norm(away) / (globe->radius + gap), 1);
}

/* Distance of a point from a margin, mm. */
static double off_margin(const struct opening *o, int lid, const float at[2])
{
	double least = INFINITY;
	for (int i = 0; i < o->n; i++)
		least = fmin(least, hypot(at[0] - o->first - i, at[1] - o->y[lid][i]));
	return least / o->px_per_mm;
}

/* Lids have a breadth: seen from the front, the outer edge of a margin stands off the line at which the eyeball ends. How far a vertex
 * must come towards that line for the outer edges to meet, px; down is positive. */
static double breadth(const struct opening *o, int lid, const float at[2], double outside, const struct rig_conf *conf)
{
	const double x = fmin(fmax(at[0] - o->first, 0), o->n - 1), beyond = fmax(o->first - at[0], at[0] - o->first - o->n + 1);
	const double hollow = fmin(fmax(fmax(o->end[0] - x, x - o->end[1]) / o->scale, 0), 1), off = o->y[lid][(int)x] - at[1];
	const double most = outside * o->scale * (conf->breadth[0] + hollow * (conf->breadth[1] - conf->breadth[0]));
	return (lid == UPPER ? fmin(fmax(off, 0), most) : fmax(fmin(off, 0), -most)) * fading(beyond / o->scale, 0, 3);
}

/* Share with which skin goes with the nearer margin as one: that on a tarsus. d: from both margins, mm. */
static double on_tarsus(const struct rig *rig, int i, const struct opening *o, const double d[LIDS], const struct rig_conf *conf)
{
	const double unit = o->px_per_mm / o->scale;
	return fading(fmin(d[UPPER], d[LOWER]) * unit, conf->tarsus[0], conf->tarsus[1]) * fading(rig->gap[i] * unit, conf->lid_gap, 2 * conf->lid_gap);
}

/* lack: what shut() added to the upper margin, px. */
static void apply(struct rig *rig, int i, const struct opening *o, const double coefficient[TERMS][RIG_BASIS],
                  const double closing[RIG_COMPONENTS], double lack, const double gap[LIDS], const struct rig_conf *conf)
{
	double most = 0, total = 0, sum[RIG_BASIS] = { 0 }, away[LIDS], open[TERMS];
	const double out = outside(rig, i);
	for (int lid = 0; lid < LIDS; lid++) {
		const double near = out + (1 - out) * nearer_in(rig, i, gap[lid]);
		double g[TERMS], d = off_margin(o, lid, rig->home[i]), share = fading(d, 0.25 * conf->lid, conf->lid), w = share / (0.01 + d * d);
		away[lid] = d;
		terms_at(g, o, lid, rig->home[i][0], fmax((d - margin_mm) * o->px_per_mm, 0.5));
		most = fmax(most, share);
		total += w;
		for (int k = 0; k < RIG_BASIS; k++)
			for (int j = 0; j < TERMS; j++)
				sum[k] += w * near * g[j] * coefficient[j][k];
		for (int k = 0; k < RIG_COMPONENTS; k++)
			sum[RIG_COMPONENTS + k] += w * breadth(o, lid, rig->home[i], out, conf) * closing[k];
	}
	most *= fading(rig->gap[i] * o->px_per_mm / o->scale, conf->lid_gap - gap_fade, conf->lid_gap + gap_fade);
	for (int k = 0; k < RIG_BASIS && total > 0; k++)
		rig->basis[i][k] += (float)(most * (sum[k] / total - rig->basis[i][k]));
	// A lid turns about the eyeball as one, its outside, too: else the outer edge of a thick margin sinks behind the inner one.
	const double as_one = on_tarsus(rig, i, o, away, conf), more = away[UPPER] > away[LOWER] ? 0 : fmax(as_one - most, 0);
	rig->glue[i] = (float)as_one;
	terms_at(open, o, UPPER, rig->home[i][0], fmax((away[UPPER] - margin_mm) * o->px_per_mm, 0.5));
	for (int k = 0; k < RIG_COMPONENTS && more > 0; k++)
		rig->basis[i][RIG_COMPONENTS + k] += (float)(more * (open[2 + UPPER] * lack + (lack > 0) * breadth(o, UPPER, rig->home[i], out, conf)) * closing[k]);
}

void rig_arc_margins(struct rig *rig, const struct rig_motion *m, double px_per_mm, const struct rig_conf *conf)
{
	for (int side = 0; side < 2 && conf->lid > 0; side++) {
		struct opening o;
		double coefficient[TERMS][RIG_BASIS], closed[RIG_COMPONENTS], closing[RIG_COMPONENTS] = { 0 }, lack = 0;
		if (!opening_of(&o, rig, m, side, px_per_mm, conf))
			continue;
		bool ok = fit(coefficient, &o, rig, side, conf->lid_gap);
		if (ok && conf->seal >= 0) {
			rig_closed_pose(closed, rig);
			rig_closing_direction(closing, rig, side, closed);
			lack = shut(coefficient, &o, closed, closing, conf->seal);
		}
		const double gap[LIDS] = { outside_gap(&o, rig, side, UPPER, conf->lid_gap), outside_gap(&o, rig, side, LOWER, conf->lid_gap) };
		for (int i = 0; i < rig->n && ok; i++)
			if (!rig_is_globe(rig->part[i]) && rig->side[i] == side)
				apply(rig, i, &o, (const double(*)[RIG_BASIS])coefficient, closing, fmax(lack, 0), gap, conf);
		opening_free(&o);
	}
}
