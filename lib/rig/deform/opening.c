#include "rig/deform/opening.h"

#include <math.h>

#include "math/vec.h"
#include "rig/deform/room.h"

enum { COLUMNS = DEFORM_COLUMNS };
static const double before = 0.2;               // of a globe's radius: skin further back lines the socket
static const double reach = 1.2;                // of it: columns to either side
static const double step_mm = 0.4;              // the same: from one column to the next, a tenth of a millimetre, a margin goes up or down by less

void deform_in_head(double out[3], const struct rig *rig, int side, const float x[3])
{
	double d[3];
	for (int c = 0; c < 3; c++)
		d[c] = x[c] - rig->globe[side].center[c];
	mat_vec(out, rig->head_from_target, d);
}

static void add_face(struct deform_room *to, const double *const p[3], double step)
{
	const double least = fmin(fmin(p[0][0], p[1][0]), p[2][0]) / step, most = fmax(fmax(p[0][0], p[1][0]), p[2][0]) / step;
	const int from = (int)fmax(ceil(least) + COLUMNS / 2, 0), to_column = (int)fmin(floor(most) + COLUMNS / 2, COLUMNS - 1);
	for (int i = from; i <= to_column; i++) {
		const double x = step * (i - COLUMNS / 2);
		struct deform_cover c = { i, INFINITY, -INFINITY };
		for (int k = 0; k < 3; k++) {
			const double *a = p[k], *b = p[(k + 1) % 3];
			if ((a[0] <= x) == (b[0] <= x))
				continue;
			const double y = a[1] + (b[1] - a[1]) * (x - a[0]) / (b[0] - a[0]);
			c.low = fmin(c.low, y);
			c.high = fmax(c.high, y);
		}
		if (!(c.high >= c.low))
			continue;
		deform_room_grow(to);
		to->cover[to->n++] = c;
	}
}

static bool before_in_place(const struct deform_cover *p, const struct deform_cover *q)
{
	return p->column != q->column ? p->column < q->column : p->low < q->low;
}

/* By columns, and upwards in each, into `sorted`: by counting, to a part of the height, and the few that are left by insertion. */
static void sort(struct deform_room *c, double radius)
{
	enum { PARTS = 64 };
	struct deform_cover *out = c->sorted;
	int from[COLUMNS * PARTS + 1] = { 0 };
	for (int i = 0; i < c->n; i++) {
		const double part = PARTS / 2 * (1 + c->cover[i].low / (2 * radius));
		c->place[i] = c->cover[i].column * PARTS + (int)fmin(fmax(part, 0), PARTS - 1);
		from[c->place[i] + 1]++;
	}
	for (int i = 0; i < COLUMNS * PARTS; i++)
		from[i + 1] += from[i];
	for (int i = 0; i < c->n; i++)
		out[from[c->place[i]]++] = c->cover[i];
	for (int i = 1; i < c->n; i++) {
		const struct deform_cover now = out[i];
		int k = i;
		for (; k > 0 && before_in_place(&now, &out[k - 1]); k--)
			out[k] = out[k - 1];
		out[k] = now;
	}
}

/* The longest gap between covers of each column that has its middle between two heights, and that before the eyeball: what is no lid has gaps, too. */
static void take_gaps(struct deform_opening *o, const struct deform_room *c, double radius, const double within[2])
{
	for (int i = 0; i < COLUMNS; i++)
		o->top[i] = o->bottom[i] = 0;
	for (int k = 0; k < c->n;) {
		const int column = c->sorted[k].column;
		const double x = o->step * (column - COLUMNS / 2);
		double high = c->sorted[k].high;
		for (; k < c->n && c->sorted[k].column == column; k++) {
			const double middle = 0.5 * (high + c->sorted[k].low);
			if (c->sorted[k].low - high > o->top[column] - o->bottom[column] && middle > within[0] && middle < within[1] && hypot(x, middle) < radius) {
				o->bottom[column] = high;
				o->top[column] = c->sorted[k].low;
			}
			high = fmax(high, c->sorted[k].high);
		}
	}
}

/* The outer eighths end where the upper margin steps: what is beyond lies behind it, in a corner. */
static void trim(struct deform_opening *o, int middle, double unit)
{
	const int eighth = (o->last - o->first) / 8, first = o->first, last = o->last;
	for (int i = first; i < first + eighth && i < middle; i++)
		if (fabs(o->top[i + 1] - o->top[i]) > step_mm * unit)
			o->first = i + 1;
	for (int i = last; i > last - eighth && i > middle; i--)
		if (fabs(o->top[i - 1] - o->top[i]) > step_mm * unit)
			o->last = i - 1;
}

void deform_open(struct deform_opening *o, const struct rig *rig, const struct deform_near *near, int side, const float (*x)[3], const double within[2])
{
	const double radius = rig->globe[side].radius, least = 1e-3 * radius;
	struct deform_room *room = deform_room_take(near->rooms);
	double (*head)[3] = room->head;
	int widest = 0;
	*o = (struct deform_opening){ .step = 2 * reach * radius / COLUMNS };
	for (int i = 0; i < near->n_seen[side]; i++)
		deform_in_head(head[near->seen[side][i]], rig, side, x[near->seen[side][i]]);
	for (int k = 0; k < near->n + near->n_beside; k++) {
		const int32_t *v = rig->faces[k < near->n ? near->face[k] : near->beside[k - near->n]];
		if (rig->side[v[0]] != side)
			continue;
		const double *p[3] = { head[v[0]], head[v[1]], head[v[2]] };
		if (fmin(fmin(p[0][2], p[1][2]), p[2][2]) > before * radius)
			add_face(room, p, o->step);
	}
	sort(room, radius);
	take_gaps(o, room, radius, within);
	deform_room_give(near->rooms, room);
	for (int i = 0; i < COLUMNS; i++)
		widest = o->top[i] - o->bottom[i] > o->top[widest] - o->bottom[widest] ? i : widest;
	o->first = widest;
	o->last = o->top[widest] - o->bottom[widest] > least ? widest : widest - 1;
	const int middle = widest;
	while (o->last >= o->first && o->first > 0 && o->top[o->first - 1] - o->bottom[o->first - 1] > least)
		o->first--;
	while (o->last >= o->first && o->last + 1 < COLUMNS && o->top[o->last + 1] - o->bottom[o->last + 1] > least)
		o->last++;
	trim(o, middle, radius / 12);
}

double deform_hull(double *hull, int n, const double *y)
{
	double worst = 0;
	for (int a = 0, b; a < n; a = b) {
		hull[a] = y[a];
		b = a + 1;
		for (int i = a + 2; i < n; i++)  // the steepest way on
			b = (y[i] - y[a]) * (b - a) >= (y[b] - y[a]) * (i - a) ? i : b;
		for (int i = a + 1; i < b && b < n; i++) {
			hull[i] = y[a] + (y[b] - y[a]) * (i - a) / (b - a);
			worst = fmax(worst, hull[i] - y[i]);
		}
	}
	return worst;
}
