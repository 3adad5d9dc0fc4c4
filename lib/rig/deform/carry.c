#include "rig/deform/carry.h"

#include <lapacke.h>
#include <math.h>
#include <string.h>

#include "math/vec.h"
#include "rig/deform/room.h"

/* The rotation that takes a patch at rest best to where it is, as a unit quaternion (Horn, Closed-form solution of absolute orientation using unit quaternions, 1987). */
static void turn_of(double turn[4], const struct deform_root *r, const float (*x)[3], const float (*rest)[3])
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
	for (int k = 0; k < 4; k++)
		turn[k] = ok ? N[k][3] : k == 0;
}

static void matrix_of(double R[3][3], const double q[4])
{
	const double n = 1 / sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]), w = q[0] * n, a = q[1] * n, b = q[2] * n, c = q[3] * n;
	const double of[3][3] = { { w * w + a * a - b * b - c * c, 2 * (a * b - w * c), 2 * (a * c + w * b) },
		                      { 2 * (a * b + w * c), w * w - a * a + b * b - c * c, 2 * (b * c - w * a) },
		                      { 2 * (a * c - w * b), 2 * (b * c + w * a), w * w - a * a - b * b + c * c } };
	memcpy(R, of, sizeof of);
}

/* Where a vertex goes: as one body with its roots, by the mean of their rotations; a mean of the places they would each turn it to comes nearer to them the less
 * alike they turn. Quaternions are as close to each other's as they can be: of both signs of the same rotation that which agrees with the first. */
static void carry(float to[3], const struct deform_carried *v, const struct deform_root *root, const struct deform_motion *motion, const float rest[3])
{
	double turn[4] = { 0 }, from[3] = { 0 }, foot[3] = { 0 }, d[3], turned[3], R[3][3];
	const double *first = motion[v->root[0]].turn;
	for (int k = 0; k < v->n; k++) {
		const struct deform_motion *m = &motion[v->root[k]];
		const double w = (double)v->weight[k], agree = first[0] * m->turn[0] + first[1] * m->turn[1] + first[2] * m->turn[2] + first[3] * m->turn[3];
		for (int c = 0; c < 4; c++)
			turn[c] += (agree < 0 ? -w : w) * m->turn[c];
		for (int c = 0; c < 3; c++) {
			from[c] += w * root[v->root[k]].at[c];
			foot[c] += w * m->foot[c];
		}
	}
	matrix_of(R, turn);
	for (int c = 0; c < 3; c++)
		d[c] = (double)rest[c] - from[c];
	mat_vec(turned, (const double(*)[3])R, d);
	for (int c = 0; c < 3; c++)
		to[c] = (float)(foot[c] + turned[c]);
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
		carry(x[v->vertex], v, cards->root, motion, rig->rest[v->vertex]);
	}
	deform_room_give(rooms, room);
}
