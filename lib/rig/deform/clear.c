#include "rig/deform/clear.h"

#include <math.h>
#include <string.h>

#include "math/vec.h"
#include "rig/deform/room.h"

enum { ROUNDS = 4, SAMPLES = 4 };
static const double deepest_mm = 2;       // what lies deeper is no lid before the eye
static const double outwards = 0.3;       // least cosine of a face's normal with the way out
static const float margin_mm = 0.4f, margin_share = 0.15f;  // at rest so near is the lid's margin; what it gives way, of others

static bool faces_out(const float (*x)[3], const int32_t v[3], const double center[3])
{
	double a[3], b[3], n[3], m[3];
	for (int c = 0; c < 3; c++) {
		a[c] = x[v[1]][c] - x[v[0]][c];
		b[c] = x[v[2]][c] - x[v[0]][c];
		m[c] = (x[v[0]][c] + x[v[1]][c] + x[v[2]][c]) / 3 - center[c];
	}
	vec_cross(n, a, b);
	return vec_dot(n, m) > outwards * vec_norm(n) * vec_norm(m);
}

/* What the corners of a face have to move outwards, at least, for a sample of it (the middle of the edge across from corner `of`; of
 * the face for 3). */
static void ask(float *push, const struct rig *rig, const struct deform_near *near, const float (*x)[3], const int32_t v[3], int of, const double target_from_globe[3][3])
{
	float at[3] = { 0 }, share[3], all = 0;
	const float n = of < 3 ? 2 : 3;
	for (int k = 0; k < 3; k++) {
		share[k] = k == of || !near->moves[v[k]] ? 0 : rig->gap[v[k]] < margin_mm ? margin_share : 1;
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

void deform_clear(float (*x)[3], const struct rig *rig, const struct deform_near *near, const double target_from_globe[2][3][3])
{
	struct deform_room *room = deform_room_take(near->rooms);
	float *push = room->push;
	for (int round = 0; round < ROUNDS; round++) {
		memset(push, 0, (size_t)rig->n * sizeof *push);
		for (int i = 0; i < near->n; i++) {
			const int32_t *v = rig->faces[near->face[i]];
			const int side = rig->side[v[0]];
			const bool out = faces_out((const float(*)[3])x, v, rig->globe[side].center);
			for (int k = 0; k < SAMPLES && out; k++)
				ask(push, rig, near, (const float(*)[3])x, v, k, target_from_globe[side]);
		}
		for (int i = 0; i < rig->n; i++) {
			const double *center = rig->globe[rig->side[i]].center;
			double d[3], far;
			if (!(push[i] > 0))
				continue;
			for (int c = 0; c < 3; c++)
				d[c] = x[i][c] - center[c];
			far = fmax(vec_norm(d), 1e-6);
			for (int c = 0; c < 3; c++)
				x[i][c] += (float)(push[i] * d[c] / far);
		}
	}
	deform_room_give(near->rooms, room);
}
