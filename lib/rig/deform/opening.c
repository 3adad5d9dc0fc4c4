#include "rig/deform/opening.h"

#include <math.h>
#include <stdlib.h>

#include "base/mem.h"
#include "math/vec.h"
#include "rig/deform/room.h"

enum { COLUMNS = DEFORM_COLUMNS };
static const double before = 0.2;               // of a globe's radius: skin further back lines the socket
static const double reach = 1.2;                // of it: columns to either side
static const double step_mm = 0.6;              // the same: from one column to the next, a tenth of a millimetre, a margin goes up or down by less

void deform_in_head(double out[3], const struct rig *rig, int side, const float x[3])
{
	double d[3];
	for (int c = 0; c < 3; c++)
		d[c] = x[c] - rig->globe[side].center[c];
	mat_vec(out, rig->head_from_target, d);
}

void deform_in_head_aside(double out[3], const struct rig *rig, int side, const float x[3], double aside)
{
	deform_in_head(out, rig, side, x);
	const double c = cos(aside), s = sin(aside), right = out[0];
	out[0] = c * right - s * out[2];
	out[2] = s * right + c * out[2];
}

static int by_ends(const void *a, const void *b)
{
	const struct deform_edge *p = a, *q = b;
	return p->from != q->from ? (p->from > q->from) - (p->from < q->from) : p->to != q->to ? (p->to > q->to) - (p->to < q->to) : p->face[0] - q->face[0];
}

void deform_edges_find(struct deform_near *near, const struct rig *rig)
{
	const int n = 3 * (near->n + near->n_beside);
	struct deform_edge *edge = near->edge = mem_array((size_t)n + 1, sizeof *edge);
	for (int k = 0; k < n; k++) {
		const int32_t *v = rig->faces[deform_near_face(near, k / 3)], a = v[k % 3], b = v[(k + 1) % 3];
		edge[k] = a < b ? (struct deform_edge){ a, b, { k / 3, -1 }, { 1, 0 } } : (struct deform_edge){ b, a, { k / 3, -1 }, { -1, 0 } };
	}
	qsort(edge, (size_t)n, sizeof *edge, by_ends);
	for (int k = 0; k < n; k++) {
		struct deform_edge *last = near->n_edges ? &edge[near->n_edges - 1] : 0;
		if (last && last->from == edge[k].from && last->to == edge[k].to && last->face[1] < 0) {
			last->face[1] = edge[k].face[0];
			last->way[1] = edge[k].way[0];
		} else {
			edge[near->n_edges++] = edge[k];
		}
	}
}

/* Of each face which way round the front sees it: 1 counterclockwise, -1; 0: not of this eye, or not before it. */
static void see_faces(int *way, const double (*head)[3], const struct rig *rig, const struct deform_near *near, int side)
{
	for (int k = 0; k < near->n + near->n_beside; k++) {
		const int32_t *v = rig->faces[deform_near_face(near, k)];
		way[k] = 0;
		if (rig->side[v[0]] != side)
			continue;
		const double *a = head[v[0]], *b = head[v[1]], *c = head[v[2]], area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
		if (fmin(fmin(a[2], b[2]), c[2]) > before * rig->globe[side].radius)
			way[k] = (area > 0) - (area < 0);
	}
}

/* Where an edge crosses columns. A column's number is tested by its place itself: all edges of a vertex then agree which of them the column crosses. */
static void cross(struct deform_room *to, const double p[3], const double q[3], int change, double step)
{
	const double *a = p[0] < q[0] ? p : q, *b = p[0] < q[0] ? q : p;
	const int first = (int)fmax(ceil(a[0] / step) + COLUMNS / 2 - 1, 0), last = (int)fmin(floor(b[0] / step) + COLUMNS / 2 + 1, COLUMNS - 1);
	for (int i = first; i <= last; i++) {
		const double x = step * (i - COLUMNS / 2);
		if (!(a[0] <= x && x < b[0]))
			continue;
		deform_room_hold(to, to->n + 1);
		to->crossing[to->n++] = (struct deform_crossing){ i, change, a[1] + (b[1] - a[1]) * (x - a[0]) / (b[0] - a[0]) };
	}
}

/* The edges at which the cover of faces begins or ends: most have faces on both sides, and are none. */
static void cross_all(struct deform_room *to, const struct deform_near *near, double step)
{
	for (int k = 0; k < near->n_edges; k++) {
		const struct deform_edge *e = &near->edge[k];
		const double *p = to->head[e->from], *q = to->head[e->to];
		const int round = to->way[e->face[0]] * e->way[0] + (e->face[1] < 0 ? 0 : to->way[e->face[1]] * e->way[1]);
		// What is to the left of an edge that runs to the right lies above it.
		if (round)
			cross(to, p, q, p[0] < q[0] ? round : -round, step);
	}
}

/* By columns, and upwards in each, into `sorted`: few are in one. */
static void sort(struct deform_room *c)
{
	int from[COLUMNS + 1] = { 0 }, n[COLUMNS] = { 0 };
	for (int i = 0; i < c->n; i++)
		from[c->crossing[i].column + 1]++;
	for (int i = 0; i < COLUMNS; i++)
		from[i + 1] += from[i];
	for (int i = 0; i < c->n; i++) {
		const struct deform_crossing now = c->crossing[i];
		int k = from[now.column] + n[now.column]++;
		for (; k > from[now.column] && c->sorted[k - 1].y > now.y; k--)
			c->sorted[k] = c->sorted[k - 1];
		c->sorted[k] = now;
	}
}

/* The longest gap in the cover of each column that has its middle between two heights, and that before the eyeball: what is no lid has gaps, too. */
static void take_gaps(struct deform_opening *o, const struct deform_room *c, double radius, const double within[2])
{
	for (int i = 0; i < COLUMNS; i++)
		o->top[i] = o->bottom[i] = 0;
	for (int k = 0; k < c->n;) {
		const int column = c->sorted[k].column;
		const double x = o->step * (column - COLUMNS / 2);
		double high = INFINITY;
		for (int cover = 0; k < c->n && c->sorted[k].column == column; k++) {
			const double y = c->sorted[k].y, middle = 0.5 * (high + y);
			const bool was = cover > 0, is = (cover += c->sorted[k].change) > 0;
			if (!was && is && y - high > o->top[column] - o->bottom[column] && middle > within[0] && middle < within[1] && hypot(x, middle) < radius) {
				o->bottom[column] = high;
				o->top[column] = y;
			}
			high = was && !is ? y : high;
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
	deform_open_aside(o, rig, near, side, x, within, 0);
}

void deform_open_aside(struct deform_opening *o, const struct rig *rig, const struct deform_near *near, int side, const float (*x)[3], const double within[2], double aside)
{
	const double radius = rig->globe[side].radius, least = 1e-3 * radius;
	struct deform_room *room = deform_room_take(near->rooms);
	double (*head)[3] = room->head;
	int widest = 0;
	*o = (struct deform_opening){ .step = 2 * reach * radius / COLUMNS };
	for (int i = 0; i < near->n_seen[side]; i++)
		deform_in_head_aside(head[near->seen[side][i]], rig, side, x[near->seen[side][i]], aside);
	deform_room_hold(room, near->n + near->n_beside);
	see_faces(room->way, (const double(*)[3])head, rig, near, side);
	cross_all(room, near, o->step);
	sort(room);
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
