#include "rig/deform/slide.h"

#include <math.h>

#include "math/rising.h"
#include "math/vec.h"
#include "rig/deform/opening.h"

enum { COLUMNS = DEFORM_COLUMNS, ROUNDS = 4, REACH = 12 };  // columns to either side that go along: a margin has no notches
static const double told_mm[] = { 0.6, 1.2 };     // of an eyeball of 12 mm: lids less apart than the first meet, from the second they are as posed
static const double before = 0.95;                // of an eyeball's radius: lids are no further from its middle
static const double least_mm = 0.01;              // the same: more than rounding
static const double over_mm = 0.3;                // the same: so far the upper one goes on
static const double goes_along_mm[] = { 1.5, 8 }; // the same: skin above the margin goes with it up to the first, not at all from the second

void deform_slide(float x[3], const struct rig *rig, int side, const double target_from_globe[3][3], double up)
{
	const double was = rig_globe_distance(rig, side, target_from_globe, x);
	double d[3], far;
	for (int c = 0; c < 3; c++) {
		x[c] += (float)(up * rig->head_from_target[1][c]);
		d[c] = x[c] - rig->globe[side].center[c];
	}
	const double lack = was - rig_globe_distance(rig, side, target_from_globe, x);
	far = fmax(vec_norm(d), 1e-6);
	for (int c = 0; c < 3; c++)
		x[c] += (float)(lack * d[c] / far);
}

/* Keeps of an opening what is a slit between lids: more than rounding, not at the eyeball's side, and in columns in which the eye is open at rest or that are corners
 * of its opening, of which deform_open leaves out up to a sixth of the rest. */
static void between_lids(struct deform_opening *o, const struct deform_opening *rest, double radius)
{
	const int corner = (rest->last - rest->first) / 6 + 1;
	for (int i = 0; i < COLUMNS; i++) {
		const bool aside = hypot(o->step * (i - COLUMNS / 2), 0.5 * (o->top[i] + o->bottom[i])) > before * radius;
		if (i < rest->first - corner || i > rest->last + corner || aside || o->top[i] - o->bottom[i] < least_mm * radius / 12)
			o->top[i] = o->bottom[i] = 0;
	}
}

/* How far the margin has to come down, mm: over a reach to either side the most, then the mean. Returns the widest slit, mm. */
static double take_slit(double by[COLUMNS], const struct deform_opening *o, double over)
{
	double most[COLUMNS], widest = 0;
	for (int i = 0; i < COLUMNS; i++) {
		most[i] = 0;
		for (int k = i < REACH ? 0 : i - REACH; k <= i + REACH && k < COLUMNS; k++)
			most[i] = fmax(most[i], o->top[k] - o->bottom[k]);
		widest = fmax(widest, o->top[i] - o->bottom[i]);
	}
	for (int i = 0; i < COLUMNS; i++) {
		by[i] = 0;
		for (int k = i - REACH; k <= i + REACH; k++)
			by[i] += k >= 0 && k < COLUMNS && most[k] > 0 ? (most[k] + over) / (2 * REACH + 1) : 0;
	}
	return widest;
}

/* The height of the margin in each column, mm: where it is shut, between those of columns where it is not; NAN where none is. */
static void take_margin(double y[COLUMNS], const struct deform_opening *o)
{
	int last = -1;
	for (int i = 0; i < COLUMNS; i++)
		y[i] = NAN;
	for (int i = 0; i < COLUMNS; i++) {
		if (!(o->top[i] > o->bottom[i]))
			continue;
		for (int k = last + 1; k <= i; k++)
			y[k] = last < 0 ? o->top[i] : o->top[last] + (o->top[i] - o->top[last]) * (k - last) / (i - last);
		last = i;
	}
	for (int k = last + 1; k < COLUMNS && last >= 0; k++)
		y[k] = o->top[last];
}

/* As seen from there; rest: the opening at rest from there. False: lids are apart. */
static bool shut_from(float (*x)[3], const struct rig *rig, const struct deform_near *near, int side, const double target_from_globe[3][3], const struct deform_opening *rest, double from)
{
	const double unit = rig->globe[side].radius / 12;
	double share = 1, last = INFINITY, by[COLUMNS], margin[COLUMNS];
	for (int round = 0; round < ROUNDS && share > 0; round++) {
		struct deform_opening now;
		deform_open_aside(&now, rig, near, side, (const float(*)[3])x, near->within[side], from);
		between_lids(&now, rest, rig->globe[side].radius);
		const double widest = take_slit(by, &now, over_mm * unit);
		if (!(widest > 0 && widest < last))
			return true;
		last = widest;
		share = round ? share : 1 - rising(widest / unit, told_mm[0], told_mm[1]);
		take_margin(margin, &now);
		for (int i = 0; i < rig->n && share > 0; i++) {
			double p[3];
			if (!(near->upper[i] > 0) || rig->side[i] != side)
				continue;
			deform_in_head_aside(p, rig, side, x[i], from);
			const int column = (int)lrint(p[0] / now.step) + COLUMNS / 2;
			if (!(p[2] > 0) || column < 0 || column >= COLUMNS || !(by[column] > 0))
				continue;
			const double with = (double)near->upper[i] * (1 - rising((p[1] - margin[column]) / unit, goes_along_mm[0], goes_along_mm[1]));
			deform_slide(x[i], rig, side, target_from_globe, -with * share * by[column]);
		}
		if (share < 1)  // what is left is as asked
			return share > 0;
	}
	return share > 0;
}

void deform_shut(float (*x)[3], const struct rig *rig, const struct deform_near *near, int side, const double target_from_globe[3][3])
{
	bool shut = shut_from(x, rig, near, side, target_from_globe, &near->rest[side], 0);
	for (int k = 0; k < 2 && shut; k++)
		shut = shut_from(x, rig, near, side, target_from_globe, &near->rest_aside[2 * side + k], k ? -DEFORM_ASIDE : DEFORM_ASIDE);
}
