#include "track/clip/to_outlines.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "track/clip/outlines.h"
#include "track/lid/line.h"

/* Share of the way from a corner within which the evidence's outline is round where the lids meet in a point: it does not tell the margin there. */
static const double rounded = 0.06;
/* At a corner, control points that its own motion is taken from, and over which it fades. Squared, the motion of a corner along both margins that is not told. */
enum { NEAR_CORNER = 2, FADES = 4 };
static const double ridge = 0.3;

typedef double by_point[LIDS][LID_POINTS_MAX];

/* 1 where the upper margin lies to the right of the way from the inner corner to the outer, as of a face that is shown upright and not mirrored the person's right one does; else -1. */
static double right_hand(const struct track_result *r, int side)
{
	double sum = 0;
	for (long f = 0; f < r->n; f++) {
		const struct eye_state *s = &r->eyes.state[f][side];
		const double *up = s->lid[LID_UPPER][s->lid_points / 2], *low = s->lid[LID_LOWER][s->lid_points / 2], *a = s->lid[LID_UPPER][0], *b = s->lid[LID_UPPER][s->lid_points - 1];
		const double cross = (b[0] - a[0]) * (up[1] - low[1]) - (b[1] - a[1]) * (up[0] - low[0]);
		sum += isfinite(cross) ? cross : 0;
	}
	return sum < 0 ? -1 : 1;
}

/* Unit vectors out of the opening at the control points. hand: as of right_hand. */
static void outwards(double out[][2], const struct eye_state *s, int lid, double hand)
{
	const double side = lid == LID_UPPER ? hand : -hand;
	for (int i = 0; i < s->lid_points; i++) {
		const double *a = s->lid[lid][i > 0 ? i - 1 : 0], *b = s->lid[lid][i + 1 < s->lid_points ? i + 1 : i];
		const double t[2] = { b[0] - a[0], b[1] - a[1] }, length = fmax(hypot(t[0], t[1]), 1e-9);
		out[i][0] = -side * t[1] / length;
		out[i][1] = side * t[0] / length;
	}
}

/* How far the outline lies beyond each control point, of the iris' radius; NAN where it tells nothing. */
static void apart(by_point off, const struct eye_state *s, const struct eye_outline *o, double hand, const struct track_conf *conf)
{
	const double radius = (double)o->radius;
	for (int k = 0; k < LIDS; k++) {
		double out[LID_POINTS_MAX][2];
		outwards(out, s, k, hand);
		for (int i = 0; i < s->lid_points; i++) {
			const double u = line_along(s->lid[k][i], s->lid[k][0], s->lid[k][s->lid_points - 1]);
			off[k][i] = u < rounded || u > 1 - rounded ? NAN : eye_outline_apart(o, k, s->lid[k][i], out[i], conf->outlines.most * radius) / radius + conf->canthi.outline_beyond;
		}
	}
}

/* Fills gaps from the neighbours, and smooths along the margin. False: nothing is known. */
static bool whole(double off[], int n)
{
	double filled[LID_POINTS_MAX];
	int last = -1;
	for (int i = 0; i < n; i++) {
		if (isnan(off[i]))
			continue;
		for (int j = last + 1; j < i; j++)
			filled[j] = last < 0 ? off[i] : off[last] + (off[i] - off[last]) * (j - last) / (i - last);
		filled[i] = off[i];
		last = i;
	}
	for (int j = last + 1; j < n && last >= 0; j++)
		filled[j] = off[last];
	for (int i = 0; i < n && last >= 0; i++)
		off[i] = 0.25 * filled[i > 0 ? i - 1 : 0] + 0.5 * filled[i] + 0.25 * filled[i + 1 < n ? i + 1 : n - 1];
	return last >= 0;
}

/* The motion of a corner that moves both margins beside it as they are to be moved: least squares, drawn to none. */
static void corner_by(double by[2], const double out[LIDS][2], const double off[LIDS])
{
	double a[2][2] = { { ridge, 0 }, { 0, ridge } }, b[2] = { 0 };
	for (int k = 0; k < LIDS; k++)
		for (int i = 0; i < 2; i++) {
			b[i] += out[k][i] * off[k];
			for (int j = 0; j < 2; j++)
				a[i][j] += out[k][i] * out[k][j];
		}
	const double det = a[0][0] * a[1][1] - a[0][1] * a[1][0];
	by[0] = (b[0] * a[1][1] - b[1] * a[0][1]) / det;
	by[1] = (b[1] * a[0][0] - b[0] * a[1][0]) / det;
}

/* Moves both margins by off, px. */
static void draw(struct eye_state *s, by_point off, double hand)
{
	const int n = s->lid_points;
	double out[LIDS][LID_POINTS_MAX][2], corner[2][2];
	for (int k = 0; k < LIDS; k++)
		outwards(out[k], s, k, hand);
	for (int c = 0; c < 2; c++) {
		const int i = c ? n - 1 - NEAR_CORNER : NEAR_CORNER;
		const double beside[LIDS][2] = { { out[0][i][0], out[0][i][1] }, { out[1][i][0], out[1][i][1] } }, by[LIDS] = { off[0][i], off[1][i] };
		corner_by(corner[c], beside, by);
	}
	for (int k = 0; k < LIDS; k++)
		for (int i = 0; i < n; i++) {
			const int end = i < n - 1 - i ? i : n - 1 - i;
			const double share = end < FADES ? 1 - (double)end / FADES : 0, *of = corner[i > n / 2];
			for (int c = 0; c < 2; c++)
				s->lid[k][i][c] += share * of[c] + (1 - share) * off[k][i] * out[k][i][c];
		}
}

/* Outlines of the open eye that margins were found in, in order of their frames, and how far they lie beyond those. */
struct told { long n, *frame; float *radius, *gap; by_point *off; };

static struct told told_of(const struct track_result *r, int side, double hand, const struct track_conf *conf)
{
	const size_t room = (size_t)r->outlines + 1;
	struct told t = { 0, mem_array(room, sizeof *t.frame), mem_array(room, sizeof *t.radius), mem_array(room, sizeof *t.gap), mem_array(room, sizeof *t.off) };
	for (long i = 0; i < r->outlines; i++) {
		const struct track_outline *o = &r->outline[i];
		const struct eye_state *s = o->side == side && o->frame < r->n ? &r->eyes.state[o->frame][side] : 0;
		if (!s || r->lost_at[o->frame] || !isfinite(s->lid[0][0][0]))
			continue;
		t.frame[t.n] = o->frame;
		t.radius[t.n] = o->at.radius;
		t.gap[t.n] = (float)outlines_gap(s) / o->at.radius;
		apart(t.off[t.n++], s, &o->at, hand, conf);
	}
	return t;
}

static void told_free(struct told *t)
{
	free(t->frame);
	free(t->radius);
	free(t->gap);
	free(t->off);
}

/* Means over the outlines i..end - 1 near in time, px; what is too far off, counts little. */
static bool mean(by_point by, const struct told *t, long i, long end, long frame, int side, const struct track_result *r, int points, const struct track_conf *conf)
{
	const double share = pow(conf->outlines.found_sigma, 2) / (pow(conf->outlines.found_sigma, 2) + pow(conf->canthi.outline_sigma, 2));
	by_point weight = { { 0 } };
	const double unlike_still = 1e-3;  // weight of openings that are not alike, where no others are near
	double radius = 0, sum = 0;
	memset(by, 0, sizeof(by_point));
	for (; i < end; i++) {
		const double late = (r->time[t->frame[i]] - r->time[frame]) / conf->outlines.steady_s, other = (outlines_gap(&r->eyes.state[frame][side]) / (double)t->radius[i] - (double)t->gap[i]) / conf->outlines.alike;
		const double near = (exp(-0.5 * late * late) + 1e-9) * (exp(-0.5 * other * other) + unlike_still);
		radius += near * (double)t->radius[i];
		sum += near;
		for (int k = 0; k < LIDS * points; k++) {
			const double off = t->off[i][k / points][k % points], w = isnan(off) ? 0 : near / (1 + pow(off / conf->outlines.most, 4));
			by[k / points][k % points] += w > 0 ? w * off : 0;
			weight[k / points][k % points] += w;
		}
	}
	for (int k = 0; k < LIDS * points; k++) {
		const double w = weight[k / points][k % points];
		by[k / points][k % points] *= w > 0 ? share / w * radius / sum : NAN;
	}
	return whole(by[LID_UPPER], points) && whole(by[LID_LOWER], points);
}

static void eye(struct track_result *r, int side, const struct track_conf *conf)
{
	const double far = 4 * conf->outlines.steady_s, hand = right_hand(r, side);
	struct told t = told_of(r, side, hand, conf);
	long first = 0, last = 0;
	for (long f = 0; f < r->n && t.n; f++) {
		struct eye_state *s = &r->eyes.state[f][side];
		by_point by;
		while (first + 1 < t.n && r->time[t.frame[first]] < r->time[f] - far)
			first++;
		while (last < t.n && r->time[t.frame[last]] <= r->time[f] + far)
			last++;
		// far from all: the nearest
		const long from = first < last ? first : last > 0 ? last - 1 : 0, to = last > from ? last : from + 1;
		if (isfinite(s->lid[0][0][0]) && mean(by, &t, from, to, f, side, r, s->lid_points, conf))
			draw(s, by, hand);
	}
	told_free(&t);
}

void track_outlines(struct track_result *r, const struct track_conf *conf)
{
	for (int e = 0; e < SIDES && r->has_eyes && r->outlines; e++)
		if (r->eyes.globe[e].seen)
			eye(r, e, conf);
}
