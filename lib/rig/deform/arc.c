#include "rig/deform/arc.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "math/rising.h"
#include "math/vec.h"
#include "rig/deform/along.h"
#include "rig/deform/carry.h"
#include "rig/deform/deform.h"
#include "rig/deform/lifted.h"
#include "rig/deform/room.h"
#include "rig/deform/slide.h"
#include "rig/deform/terms.h"

enum { COLUMNS = DEFORM_COLUMNS, ROUNDS = 4, LEAST = DEFORM_OPENING_LEAST };  // of arcs; columns of what is an opening
static const double near_radii = 0.5;     // of a globe, from its surface at rest: no lid comes from further
static const double lid_radii = 0.5;            // of it: skin further from the eyeball at rest is no lid
static const double drawn_mm = 0.4;             // of an eyeball of 12 mm: a margin that leaves an arc by more at rest was drawn so, or is as coarse
static const double rest_mm = 6;                // of an eyeball of 12 mm: heights between which the opening at rest has its middle
static const double shut_mm[] = { 0.2, 1 };     // of an eyeball of 12 mm: the opening up to which lids are left; from which they are not
static const double lid_share[] = { 0.1, 0.6 };  // of the way from the opening's middle to its end: where at rest a lid begins

/* How far up each open column's margin has to go: by[column], and [COLUMNS + 1] the sums of those before. */
struct lift {
	double by[COLUMNS], sum[COLUMNS + 1];
};

/* Returns the margin's mean height over the line between its ends, mm. */
static double take_lift(struct lift *l, const struct deform_opening *o, double share)
{
	const int n = o->last - o->first + 1;
	double y[COLUMNS], hull[COLUMNS], mean = 0, full = 0;
	*l = (struct lift){ 0 };
	for (int i = 0; i < n; i++) {
		y[i] = o->top[o->first + i] - o->top[o->first] - (o->top[o->last] - o->top[o->first]) * i / (n - 1);
		mean += y[i];
	}
	const double sign = mean < 0 ? -1 : 1;
	for (int i = 0; i < n; i++)
		y[i] *= sign;
	deform_hull(hull, n, y);
	for (int i = 0; i < n; i++)
		full += hull[i];
	for (int i = 0; i < n && full > 0; i++)
		l->by[o->first + i] = share * sign * (hull[i] * sign * mean / full - y[i]);
	for (int i = 0; i < COLUMNS; i++)
		l->sum[i + 1] = l->sum[i] + l->by[i];
	return mean / n;
}

static double lift_over(const struct lift *l, double from, double to)
{
	const double a = fmin(fmax(from, 0), COLUMNS - 1), b = fmin(fmax(to, 0), COLUMNS - 1);
	const int i = (int)a, j = (int)b;
	return b > a ? (l->sum[j] + (b - j) * l->by[j] - l->sum[i] - (a - i) * l->by[i]) / (b - a) : 0;
}

/* The lids of an eye, and where its opening is looked for. */
static void find_lids(struct deform_near *near, const struct rig *rig, int side)
{
	const double unit = rig->globe[side].radius / 12;
	double *within = near->within[side];
	deform_open(&near->rest[side], rig, near, side, (const float(*)[3])rig->rest, (double[]){ -rest_mm * unit, rest_mm * unit });
	const struct deform_opening o = near->rest[side];
	within[0] = within[1] = 0;
	for (int i = o.first; i <= o.last; i++) {
		within[0] = fmin(within[0], o.bottom[i] - unit);
		within[1] = fmax(within[1], o.top[i] + unit);
	}
	for (int v = 0; v < rig->n && o.last - o.first >= LEAST; v++) {
		double p[3];
		if (!near->moves[v] || rig_is_globe(rig->part[v]) || rig->side[v] != side || rig->gap[v] > lid_radii * rig->globe[side].radius)
			continue;
		deform_in_head(p, rig, side, rig->rest[v]);
		const int i = (int)fmin(fmax(p[0] / o.step + COLUMNS / 2, o.first), o.last);
		const double middle = 0.5 * (o.top[i] + o.bottom[i]), over = (p[1] - middle) / fmax(o.top[i] - middle, o.step);
		const double lid = 1 - rising(rig->gap[v] / rig->globe[side].radius, 0.6 * lid_radii, lid_radii);
		near->upper[v] = (float)(lid * rising(over, lid_share[0], lid_share[1]));
		near->lower[v] = (float)(lid * rising(-over, lid_share[0], lid_share[1]));
	}
	for (int k = 0; k < 2; k++)
		deform_open_aside(&near->rest_aside[2 * side + k], rig, near, side, (const float(*)[3])rig->rest, within, k ? -DEFORM_ASIDE : DEFORM_ASIDE);
}

/* One round: how far margins are from arcs, and that much further. arch: out, the margin's mean height before. False: there is no opening, arch 0. */
static bool nearer(double *arch, float (*x)[3], const struct rig *rig, const struct deform_near *near, int side, const double target_from_globe[3][3])
{
	struct deform_opening now;
	struct lift lift;
	const double unit = rig->globe[side].radius / 12;
	double most = 0;
	*arch = 0;
	deform_open(&now, rig, near, side, (const float(*)[3])x, near->within[side]);
	for (int i = now.first; i <= now.last; i++)
		most = fmax(most, now.top[i] - now.bottom[i]);
	const double share = rising(most / unit, shut_mm[0], shut_mm[1]);
	if (now.last - now.first < LEAST || !(share > 0))
		return false;
	*arch = share * take_lift(&lift, &now, share);
	for (int i = 0; i < rig->n; i++) {
		double p[3];
		if (!(near->upper[i] > 0) || rig->side[i] != side)
			continue;
		deform_in_head(p, rig, side, x[i]);
		const double column = p[0] / now.step + COLUMNS / 2;
		if (!(p[2] > 0) || column < now.first || column > now.last)
			continue;
		const double above = (p[1] - now.top[(int)lrint(column)]) / unit, spread = fmax((above - 1) * unit / now.step, 0.5);
		const double with = (double)near->upper[i] * (1 - rising(above, deform_goes_along_mm[0], deform_goes_along_mm[1]));
		if (with > 0)
			deform_slide(x[i], rig, side, target_from_globe, with * lift_over(&lift, column - spread, column + spread));
	}
	return true;
}

/* Moves the upper lids' skin over the eyeballs, up or down, so that between the corners of the opening, as the front sees it, the margin has
 * curvature of one sign: the margin's convex hull, upper where it lies above the line between the corners in the mean and lower where it lies below,
 * brought to the same mean height. What is such an arc already stays; so do corners, the lower lids, and skin's distance from the
 * eyeball. What a character's own margin differs by from an arc at rest it keeps, in proportion to how high it is arched; where that is
 * more than 0.4 mm of an eyeball of 12 mm, lids are left as they are. Skin above goes along, the less the higher. Lids that are nearly shut are left: there the upper margin lies on the lower one.
 * x  [rig.n], the target's frame, mm, in and out: the skin of one side;  target_from_globe  of its globe in this pose */
static void arcs(float (*x)[3], const struct rig *rig, const struct deform_near *near, int side, const double target_from_globe[3][3])
{
	double arch = 0, later;
	bool open = nearer(&arch, x, rig, near, side, target_from_globe);
	for (int round = 1; round < ROUNDS && open; round++)
		open = nearer(&later, x, rig, near, side, target_from_globe);
	const double kept = near->arch[side] > 0 ? fmin(fmax(arch / near->arch[side], -1), 1) : 0;
	for (int i = 0; i < rig->n && near->own; i++)
		if (near->upper[i] > 0 && rig->side[i] == side)
			deform_slide(x[i], rig, side, target_from_globe, kept * (double)near->own[i]);
}

static double widest(const struct deform_near *near, const struct rig *rig, int side)
{
	double most = 0;
	for (int i = 0; i < rig->n; i++)
		if (rig->side[i] == side && near->upper[i] > 0)
			most = fmax(most, fabs((double)near->own[i]));
	return most;
}

/* At rest, what lies in an eyeball being put before it as in every pose. */
static void take_own(struct deform_near *near, const struct rig *rig)
{
	float (*x)[3] = mem_new((size_t)rig->n + 1, sizeof *x), *own = mem_new((size_t)rig->n + 1, sizeof *own);
	struct deform *deform = deform_new(rig);
	double turn[2][3][3], later;
	for (int side = 0; side < 2; side++)
		rig_globe_rotation(turn[side], rig, (double[]){ 0, 0, 0 });
	deform_rest(deform, x, 0);
	deform_pose(deform, rig->rest_e, (const double(*)[3][3])turn, x, 0);
	for (int i = 0; i < 3 * rig->n; i++)
		own[i / 3] += (float)(rig->head_from_target[1][i % 3] * x[i / 3][i % 3]);
	for (int side = 0; side < 2; side++) {
		bool open = nearer(&near->arch[side], x, rig, near, side, (const double(*)[3])turn[side]);
		for (int round = 1; round < ROUNDS && open; round++)
			open = nearer(&later, x, rig, near, side, (const double(*)[3])turn[side]);
	}
	for (int i = 0; i < 3 * rig->n; i++)
		own[i / 3] -= (float)(rig->head_from_target[1][i % 3] * x[i / 3][i % 3]);
	near->own = own;
	for (int side = 0; side < 2; side++)
		if (widest(near, rig, side) > drawn_mm * rig->globe[side].radius / 12)
			for (int i = 0; i < rig->n; i++)
				if (rig->side[i] == side)
					near->upper[i] = near->lower[i] = 0;
	deform_free(deform);
	free(x);
}

static void prepare(struct deform_near *near, const struct rig *rig)
{
	near->upper = mem_new((size_t)rig->n + 1, sizeof *near->upper);
	near->lower = mem_new((size_t)rig->n + 1, sizeof *near->lower);
	near->rest = mem_new(2, sizeof *near->rest);
	near->rest_aside = mem_new(4, sizeof *near->rest_aside);
	for (int side = 0; side < 2; side++)
		find_lids(near, rig, side);
	take_own(near, rig);
}

void deform_settle(float (*x)[3], const struct rig *rig, const struct deform_near *near, const double target_from_globe[2][3][3], const double *lifted)
{
#pragma omp parallel for schedule(static, 1)
	for (int side = 0; side < 2; side++) {
		deform_along(x, rig, near, side, target_from_globe[side], lifted ? lifted[side] : 0);
		arcs(x, rig, near, side, target_from_globe[side]);
		deform_shut(x, rig, near, side, target_from_globe[side]);
	}
	deform_clear(x, rig, near, target_from_globe);
	deform_carry(x, &near->cards, rig, near->rooms);
}

/* Whether a face of skin that can not come near an eyeball lies before it at rest: without it a lid would end where its skin is far off. */
static bool covers(const struct rig *rig, const int32_t v[3])
{
	const int side = rig->side[v[0]];
	const double radius = rig->globe[side].radius;
	for (int k = 0; k < 3; k++) {
		double p[3];
		deform_in_head(p, rig, side, rig->rest[v[k]]);
		if (rig->part[v[k]] != RIG_SKIN || rig->side[v[k]] != side || !(p[2] > 0) || fabs(p[0]) > 1.2 * radius || fabs(p[1]) > 1.2 * radius)
			return false;
	}
	return true;
}

/* The vertices that the opening is found by. */
static void find_seen(struct deform_near *near, const struct rig *rig)
{
	bool *seen = mem_new((size_t)rig->n + 1, sizeof *seen);
	for (int k = 0; k < 3 * (near->n + near->n_beside); k++)
		seen[rig->faces[deform_near_face(near, k / 3)][k % 3]] = true;
	for (int side = 0; side < 2; side++)
		near->seen[side] = mem_array((size_t)rig->n + 1, sizeof *near->seen[side]);
	for (int i = 0; i < rig->n; i++)
		if (seen[i])
			near->seen[rig->side[i]][near->n_seen[rig->side[i]]++] = i;
	free(seen);
}

struct deform_near deform_near_of(const struct rig *rig)
{
	struct deform_near out = { .face = mem_new((size_t)rig->n_faces + 1, sizeof *out.face), .beside = mem_new((size_t)rig->n_faces + 1, sizeof *out.beside), .moves = mem_new((size_t)rig->n + 1, 1) };
	for (int i = 0; i < rig->n; i++)
		out.moves[i] = deform_terms_moves(rig, i);
	for (int f = 0; f < rig->n_faces; f++) {
		const int32_t *v = rig->faces[f];
		bool near = true;
		for (int k = 0; k < 3; k++)
			near = near && rig->part[v[k]] == RIG_SKIN && rig->gap[v[k]] < near_radii * rig->globe[rig->side[v[k]]].radius
			       && rig->side[v[k]] == rig->side[v[0]];
		if (near && (out.moves[v[0]] || out.moves[v[1]] || out.moves[v[2]]))
			out.face[out.n++] = f;
		else if (covers(rig, v))
			out.beside[out.n_beside++] = f;
	}
	find_seen(&out, rig);
	out.cards = deform_cards_of(rig, out.moves);
	out.rooms = deform_rooms_new(rig->n);
	deform_edges_find(&out, rig);
	prepare(&out, rig);
	deform_find_lifted(&out, rig);
	return out;
}

void deform_near_free(struct deform_near *near)
{
	free(near->face);
	free(near->beside);
	free(near->moves);
	free(near->upper);
	free(near->lower);
	free(near->rest);
	free(near->edge);
	free(near->rest_aside);
	free(near->own);
	free(near->lifted);
	deform_cards_free(&near->cards);
	free(near->seen[0]);
	free(near->seen[1]);
	deform_rooms_free(near->rooms);
	*near = (struct deform_near){ 0 };
}
