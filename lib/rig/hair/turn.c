/* Lashes that skin crosses in a pose are turned, and if that is not enough made shorter, until it crosses them in as few as can be. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "rig/deform/arc.h"
#include "rig/deform/deform.h"
#include "rig/drive.h"
#include "rig/hair/impl.h"

/* Ways to turn a lash: how far its tip goes off the eye and up, of its length; and to make it shorter. */
enum { OFF = 5, UP = 7, LENGTHS = 3, WAYS = OFF * UP * LENGTHS };
static const float off_by[OFF] = { 0, 0.25f, 0.5f, 0.8f, 1.2f }, up_by[UP] = { 0, 0.25f, -0.25f, 0.5f, -0.5f, 0.9f, -0.9f }, length_by[LENGTHS] = { 1, 0.6f, 0.35f };

/* Whether skin crosses it, beyond the piece in which it comes out. */
static bool crossed(const float at[HAIR_LASH_POINTS][3], int n, const struct ray_scene *skin)
{
	for (int k = 1; k + 1 < n; k++) {
		const float dir[3] = { at[k + 1][0] - at[k][0], at[k + 1][1] - at[k][1], at[k + 1][2] - at[k][2] };
		if (ray_blocked(skin, at[k], dir, 0, 1))
			return true;
	}
	return false;
}

/* A lash's points in its root's frame, one of the ways. */
static void turned(float out[HAIR_LASH_POINTS][3], const float (*local)[3], int n, int way)
{
	float length = 0, now = 0;
	for (int c = 0; c < 3; c++)
		length += local[n - 1][c] * local[n - 1][c];
	length = sqrtf(length);
	for (int k = 0; k < n; k++)
		for (int c = 0; c < 3; c++)
			out[k][c] = local[k][c] + (k ? length * (float)k / (float)(n - 1) * (c == 0 ? off_by[way % OFF] : c == 2 ? up_by[way / OFF % UP] : 0) : 0);
	for (int c = 0; c < 3; c++)
		now += out[n - 1][c] * out[n - 1][c];
	for (int k = 1; k < n; k++)
		for (int c = 0; c < 3; c++)
			out[k][c] *= length_by[way / (OFF * UP)] * length / sqrtf(now);
}

/* In how many poses skin crosses each lash turned each way: adds one pose. */
static void count(int (*n)[WAYS], const struct hairs *h, const struct rig *rig, const float (*x)[3], const struct ray_scene *skin)
{
#pragma omp parallel for schedule(dynamic, 8)
	for (int i = 0; i < h->n; i++) {
		const struct hair *hair = &h->hair[i];
		const struct hair_frame f = hair_frame_of(hair, rig, x);
		for (int way = 0; way < WAYS && hair->kind != HAIR_BROW; way++) {
			float local[HAIR_LASH_POINTS][3], at[HAIR_LASH_POINTS][3];
			turned(local, (const float(*)[3])h->local + hair->first, hair->n, way);
			for (int k = 0; k < hair->n; k++)
				for (int c = 0; c < 3; c++)
					at[k][c] = f.root[c] + local[k][0] * f.off[c] + local[k][1] * f.along[c] + local[k][2] * f.up[c];
			n[i][way] += crossed((const float(*)[3])at, hair->n, skin);
		}
	}
}

/* How far from what it was. */
static float change(int way)
{
	return off_by[way % OFF] + fabsf(up_by[way / OFF % UP]) + 4 * (1 - length_by[way / (OFF * UP)]);
}

static void choose(struct hairs *h, const int (*n)[WAYS])
{
	for (int i = 0; i < h->n; i++) {
		const struct hair *hair = &h->hair[i];
		float local[HAIR_LASH_POINTS][3];
		int best = 0;
		for (int way = 1; way < WAYS && hair->kind != HAIR_BROW; way++)
			best = n[i][way] < n[i][best] || (n[i][way] == n[i][best] && change(way) < change(best)) ? way : best;
		if (!best)
			continue;
		turned(local, (const float(*)[3])h->local + hair->first, hair->n, best);
		memcpy(h->local + hair->first, local, (size_t)hair->n * sizeof *local);
	}
}

void hairs_turn_out(struct hairs *h, const struct rig *rig, struct ray_scene *skin)
{
	static const double across[] = { -20, 0, 20 }, up[] = { 15, 0, -15, -25 }, open[] = { 1, 0.5, 0 };
	struct deform *deform = deform_new(rig);
	struct deform_near near = deform_near_of(rig);
	float (*x)[3] = mem_new((size_t)rig->n + 1, sizeof *x);
	double *c = mem_new((size_t)rig->n_inputs + 1, sizeof *c), e[RIG_COMPONENTS], turn[2][3][3];
	int (*n)[WAYS] = mem_new((size_t)h->n + 1, sizeof *n);
	deform_rest(deform, x, 0);
	for (int k = 0; k < COUNT(open) * COUNT(up) * COUNT(across); k++) {
		drive_look(c, rig, across[k % COUNT(across)], up[k / COUNT(across) % COUNT(up)], open[k / (COUNT(across) * COUNT(up))]);
		rig_components(e, rig, c);
		rig_globes_turned(turn, rig, c);
		deform_pose(deform, e, (const double(*)[3][3])turn, x, 0);
		deform_settle(x, rig, &near, (const double(*)[3][3])turn, 0);
		ray_scene_move(skin, (const float(*)[3])x);
		count(n, h, rig, (const float(*)[3])x, skin);
	}
	choose(h, (const int(*)[WAYS])n);
	free(n);
	free(c);
	free(x);
	deform_near_free(&near);
	deform_free(deform);
}
