#include "rig/deform/carry.h"

#include <lapacke.h>
#include <string.h>

#include "math/vec.h"
#include "rig/deform/room.h"

/* The rotation that takes a patch at rest best to where it is (Horn, Closed-form solution of absolute orientation using unit quaternions, 1987). */
static void turn_of(double turn[3][3], const struct deform_root *r, const float (*x)[3], const float (*rest)[3])
{
	double mean[2][3] = { { 0 } }, all = 0, S[3][3] = { { 0 } }, value[4];
	for (int k = 0; k < r->n; k++) {
		all += (double)r->weight[k];
		for (int c = 0; c < 3; c++) {
			mean[0][c] += (double)r->weight[k] * (double)rest[r->vertex[k]][c];
			mean[1][c] += (double)r->weight[k] * (double)x[r->vertex[k]][c];
		}
	}
	for (int k = 0; k < r->n; k++)
		for (int c = 0; c < 9; c++)
			S[c / 3][c % 3] += (double)r->weight[k] * ((double)rest[r->vertex[k]][c / 3] - mean[0][c / 3] / all) * ((double)x[r->vertex[k]][c % 3] - mean[1][c % 3] / all);
	double N[4][4] = { { S[0][0] + S[1][1] + S[2][2] },
		               { S[1][2] - S[2][1], S[0][0] - S[1][1] - S[2][2] },
		               { S[2][0] - S[0][2], S[0][1] + S[1][0], S[1][1] - S[0][0] - S[2][2] },
		               { S[0][1] - S[1][0], S[2][0] + S[0][2], S[1][2] + S[2][1], S[2][2] - S[0][0] - S[1][1] } };
	const bool ok = LAPACKE_dsyev(LAPACK_ROW_MAJOR, 'V', 'L', 4, &N[0][0], 4, value) == 0;
	const double w = ok ? N[0][3] : 1, a = ok ? N[1][3] : 0, b = ok ? N[2][3] : 0, c = ok ? N[3][3] : 0;
	const double R[3][3] = { { w * w + a * a - b * b - c * c, 2 * (a * b - w * c), 2 * (a * c + w * b) },
		                     { 2 * (a * b + w * c), w * w - a * a + b * b - c * c, 2 * (b * c - w * a) },
		                     { 2 * (a * c - w * b), 2 * (b * c + w * a), w * w - a * a - b * b + c * c } };
	memcpy(turn, R, sizeof R);
}

void deform_carry(float (*x)[3], const struct deform_cards *cards, const struct rig *rig, struct deform_rooms *rooms)
{
	struct deform_room *room = deform_room_take(rooms);
	struct deform_motion *motion = deform_room_motions(room, cards->n_roots);
	for (int k = 0; k < cards->n_roots; k++) {
		const struct deform_root *r = &cards->root[k];
		turn_of(motion[k].turn, r, (const float(*)[3])x, (const float(*)[3])rig->rest);
		for (int c = 0; c < 3; c++) {
			motion[k].foot[c] = 0;
			for (int j = 0; j < 3; j++)
				motion[k].foot[c] += (double)r->foot[j] * (double)x[r->vertex[j]][c];
		}
	}
	for (int i = 0; i < cards->n; i++) {
		const struct deform_carried *v = &cards->carried[i];
		double to[3] = { 0 };
		for (int k = 0; k < v->n; k++) {
			double d[3], turned[3];
			for (int c = 0; c < 3; c++)
				d[c] = (double)rig->rest[v->vertex][c] - cards->root[v->root[k]].at[c];
			mat_vec(turned, (const double(*)[3])motion[v->root[k]].turn, d);
			for (int c = 0; c < 3; c++)
				to[c] += (double)v->weight[k] * (motion[v->root[k]].foot[c] + turned[c]);
		}
		for (int c = 0; c < 3; c++)
			x[v->vertex][c] = (float)to[c];
	}
	deform_room_give(rooms, room);
}
