#include "rig/deform/clear.h"

#include <math.h>
#include <string.h>

#include "math/vec.h"
#include "rig/deform/room.h"

enum { ROUNDS = 4, SAMPLES = 4 };
static const double deepest_mm = 2;       // what lies deeper is no lid before the eye
static const double outwards = 0.3;       // least cosine of a face's normal with the way out
static const double inwards = -0.5;       // and most of a vertex' that lines a lid
static const double before = 0.2;         // of a globe's radius: skin further back lines the socket
static const double over_share = 0.5;     // of the way to what lies over a vertex, that it goes
static const double lining_mm = 0.5;      // of an eyeball of 12 mm: and no further, however thick the lid: a third of that, or so
static const double free_mm = 0.08;       // of an eyeball of 12 mm: it goes so far anyway, for no lid is as thin
static const float margin_mm = 0.4f, margin_share = 0.15f;  // at rest so near is the lid's margin; what it gives way, of others

bool deform_lines(const struct rig *rig, int i)
{
	const double *center = rig->globe[rig->side[i]].center;
	double away[3], normal[3];
	for (int c = 0; c < 3; c++) {
		away[c] = rig->rest[i][c] - center[c];
		normal[c] = rig->normal[i][c];
	}
	return vec_dot(normal, away) < inwards * vec_norm(away);
}

/* 1: a face looks outwards; 2: it lies before the eye, where it lines a lid; 0: what lines the socket behind lids may be as it is. */
static int is_lid(const struct rig *rig, const float (*x)[3], const int32_t v[3])
{
	const int side = rig->side[v[0]];
	const double *center = rig->globe[side].center;
	double a[3], b[3], n[3], m[3], p[3];
	for (int c = 0; c < 3; c++) {
		a[c] = x[v[1]][c] - x[v[0]][c];
		b[c] = x[v[2]][c] - x[v[0]][c];
		m[c] = (x[v[0]][c] + x[v[1]][c] + x[v[2]][c]) / 3 - center[c];
	}
	vec_cross(n, a, b);
	mat_vec(p, rig->head_from_target, m);
	return vec_dot(n, m) > outwards * vec_norm(n) * vec_norm(m) ? 1 : p[2] > before * rig->globe[side].radius ? 2 : 0;
}

/* What the corners of a face have to move outwards, at least, for a sample of it (the middle of the edge across from corner `of`; of
 * the face for 3). lining: but for those that line no lid. */
static void ask(float *push, const struct rig *rig, const struct deform_near *near, const float (*x)[3], const int32_t v[3], int of, bool lining, const double target_from_globe[3][3])
{
	float at[3] = { 0 }, share[3], all = 0;
	const float n = of < 3 ? 2 : 3;
	for (int k = 0; k < 3; k++) {
		share[k] = k == of || !near->moves[v[k]] || (lining && !deform_lines(rig, v[k])) ? 0 : rig->gap[v[k]] < margin_mm ? margin_share : 1;
		all += share[k];
		for (int c = 0; c < 3 && k != of; c++)
			at[c] += x[v[k]][c] / n;
	}
	const double deep = DEFORM_CLEAR_MM - rig_globe_distance(rig, rig->side[v[0]], target_from_globe, at);
	if (!(deep > 0) || deep > deepest_mm || !(all > 0))
		return;
	for (int k = 0; k < 3; k++)
		push[v[k]] = fmaxf(push[v[k]], (float)deep * n * share[k] / all);
}

/* How far from a place, the way d, a face is: INFINITY where it does not lie there. */
static double far_of(const float (*x)[3], const int32_t v[3], const float from[3], const double d[3])
{
	double a[3], b[3], s[3], p[3], q[3];
	for (int c = 0; c < 3; c++) {
		a[c] = (double)x[v[1]][c] - (double)x[v[0]][c];
		b[c] = (double)x[v[2]][c] - (double)x[v[0]][c];
		s[c] = (double)from[c] - (double)x[v[0]][c];
	}
	vec_cross(p, d, b);
	vec_cross(q, s, a);
	const double det = vec_dot(a, p), u = vec_dot(s, p) / det, w = vec_dot(d, q) / det, t = vec_dot(b, q) / det;
	return fabs(det) > 0 && u >= 0 && w >= 0 && u + w <= 1 && t > 0 ? t : INFINITY;
}

/* How far vertex i may go, the way d off the eyeball, of which it has gone some: what lines a lid, and looks at the eyeball, stays below its outside. */
static float most_of(const struct rig *rig, const struct deform_near *near, const float (*x)[3], int i, const double d[3], double gone)
{
	double over = INFINITY;
	if (!deform_lines(rig, i))
		return INFINITY;
	for (int k = 0; k < near->n; k++) {
		const int32_t *v = rig->faces[near->face[k]];
		if (rig->side[v[0]] == rig->side[i] && v[0] != i && v[1] != i && v[2] != i)
			over = fmin(over, far_of(x, v, x[i], d));
	}
	// Where nothing is over it, what was has gone elsewhere.
	const double unit = rig->globe[rig->side[i]].radius / 12;
	return (float)fmin(fmax(isinf(over) ? 0 : over_share * (gone + over), free_mm * unit), lining_mm * unit);
}

/* Moves vertex i by what is asked, and no further than it may. */
static void give_way(float (*x)[3], struct deform_room *room, const struct rig *rig, const struct deform_near *near, int i)
{
	const double *center = rig->globe[rig->side[i]].center;
	double d[3];
	for (int c = 0; c < 3; c++)
		d[c] = x[i][c] - center[c];
	vec_unit(d, d);
	if (!(room->most[i] > 0) && room->gone[i] + room->push[i] > free_mm * rig->globe[rig->side[i]].radius / 12)
		room->most[i] = most_of(rig, near, (const float(*)[3])x, i, d, (double)room->gone[i]);
	const float by = room->most[i] > 0 ? fmaxf(fminf(room->push[i], room->most[i] - room->gone[i]), 0) : room->push[i];
	room->gone[i] += by;
	for (int c = 0; c < 3; c++)
		x[i][c] += (float)((double)by * d[c]);
}

void deform_clear(float (*x)[3], const struct rig *rig, const struct deform_near *near, const double target_from_globe[2][3][3])
{
	struct deform_room *room = deform_room_take(near->rooms);
	memset(room->gone, 0, (size_t)rig->n * sizeof *room->gone);
	memset(room->most, 0, (size_t)rig->n * sizeof *room->most);
	for (int round = 0; round < ROUNDS; round++) {
		memset(room->push, 0, (size_t)rig->n * sizeof *room->push);
		for (int i = 0; i < near->n; i++) {
			const int32_t *v = rig->faces[near->face[i]];
			const int lid = is_lid(rig, (const float(*)[3])x, v);
			for (int k = 0; k < SAMPLES && lid; k++)
				ask(room->push, rig, near, (const float(*)[3])x, v, k, lid == 2, target_from_globe[rig->side[v[0]]]);
			for (int k = 0; k < 3 && lid == 1; k++)  // what is seen from outside comes out of the eye, however far
				room->most[v[k]] = room->push[v[k]] > 0 ? INFINITY : room->most[v[k]];
		}
		for (int i = 0; i < rig->n; i++)
			if (room->push[i] > 0)
				give_way(x, room, rig, near, i);
	}
	deform_room_give(near->rooms, room);
}
