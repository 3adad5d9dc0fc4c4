/* Lashes that skin crosses in a pose are turned, or their roots moved off the margin, and if that is not enough made shorter, until it crosses them in as few as can
 * be. Shut lids lie over each other by some tenths of a millimetre, of eyes that look aside by up to a whole one: roots on a margin's face lie under the other lid there. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "rig/deform/arc.h"
#include "rig/deform/deform.h"
#include "rig/drive.h"
#include "rig/hair/impl.h"

/* Ways to turn a lash: how far its tip goes off the eye and up, of its length; and to make it shorter. Units by which its root goes off the margin. */
enum { OFF = 5, UP = 7, LENGTHS = 3, WAYS = OFF * UP * LENGTHS, ROOTS = 4 };
static const double root_by[ROOTS] = { 0, 0.25, 0.5, 0.8 };
static const double off_seam[] = { [HAIR_UPPER] = 0.7, [HAIR_LOWER] = 1.1 };  // units over (of a lower lid: under) the seam of shut lids that no root is moved beyond
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

/* Where a lash may have its root: weighted means of three of the rig's vertices. */
struct root {
	int vertex[3];
	float weight[3];
};

/* A lash that skin crosses: its roots, the first its own, and in how many poses skin crosses it from each turned each way. */
struct lash {
	int hair, poses, n_roots;  // poses: in how many as it is
	struct root root[ROOTS];
	int n[ROOTS][WAYS];
};

static struct hair at_root(const struct hair *hair, const struct root *root)
{
	struct hair h = *hair;
	memcpy(h.vertex, root->vertex, sizeof h.vertex);
	memcpy(h.weight, root->weight, sizeof h.weight);
	return h;
}

static bool crossed_as(const float (*local)[3], const struct hair *hair, const struct hair_frame *f, const struct ray_scene *skin)
{
	float at[HAIR_LASH_POINTS][3];
	for (int k = 0; k < hair->n; k++)
		for (int c = 0; c < 3; c++)
			at[k][c] = f->root[c] + local[k][0] * f->off[c] + local[k][1] * f->along[c] + local[k][2] * f->up[c];
	return crossed((const float(*)[3])at, hair->n, skin);
}

/* A pose of the rig, its skin moved to it; poses there are. */
struct poser {
	const struct rig *rig;
	struct deform *deform;
	struct deform_near near;
	float (*x)[3];
	double *c;
	struct ray_scene *skin;
};
enum { ACROSS = 5, UPS = 5, SHUT = ACROSS * UPS, OPEN = 3 * 4, POSES = SHUT + 2 * OPEN };

static void pose(struct poser *p, double h, double v, double aperture)
{
	double e[RIG_COMPONENTS], turn[2][3][3];
	drive_look(p->c, p->rig, h, v, aperture);
	rig_components(e, p->rig, p->c);
	rig_globes_turned(turn, p->rig, p->c);
	deform_pose(p->deform, e, (const double(*)[3][3])turn, p->x, 0);
	deform_settle(p->x, p->rig, &p->near, (const double(*)[3][3])turn, 0);
	ray_scene_move(p->skin, (const float(*)[3])p->x);
}

/* Over the range of gaze, open and half open, and closer to each other shut: there it takes least for lids to lie over each other. */
static void pose_of(struct poser *p, int k)
{
	static const double across[ACROSS] = { -20, 20, 0, -10, 10 }, up[] = { 15, 0, -15, -25 }, shut_up[UPS] = { 15, 5, -5, -15, -25 };
	if (k < SHUT)
		pose(p, across[k % ACROSS], shut_up[k / ACROSS], 0);
	else
		pose(p, across[(k - SHUT) % 3], up[(k - SHUT) / 3 % 4], k < SHUT + OPEN ? 0.5 : 1);
}

/* Those that skin crosses in any pose as they are. */
static int find_crossed(struct lash *of, const struct hairs *h, struct poser *p)
{
	int *poses = mem_new((size_t)h->n + 1, sizeof *poses), n = 0;
	for (int k = 0; k < POSES; k++) {
		pose_of(p, k);
		for (int i = 0; i < h->n; i++)
			if (h->hair[i].kind != HAIR_BROW) {
				const struct hair_frame f = hair_frame_of(&h->hair[i], p->rig, (const float(*)[3])p->x);
				poses[i] += crossed_as((const float(*)[3])h->local + h->hair[i].first, &h->hair[i], &f, p->skin);
			}
	}
	for (int i = 0; i < h->n; i++)
		if (poses[i])
			of[n++] = (struct lash){ .hair = i, .poses = poses[i] };
	free(poses);
	return n;
}

/* Further roots off the margin. */
static void find_roots(struct lash *l, const struct hair *hair, const struct front *f)
{
	const struct hair_frame frame = hair_frame_of(hair, f->rig, (const float(*)[3])f->rig->rest);
	double at[3];
	front_of(at, f, frame.root);
	memcpy(l->root[0].vertex, hair->vertex, sizeof hair->vertex);
	memcpy(l->root[0].weight, hair->weight, sizeof hair->weight);
	for (l->n_roots = 1; l->n_roots < ROOTS; l->n_roots++) {
		struct front_hit hit;
		if (!lash_root(&hit, f, at[0], at[1], hair->kind == HAIR_UPPER, root_by[l->n_roots]))
			return;
		memcpy(l->root[l->n_roots].vertex, f->rig->faces[hit.face], sizeof hair->vertex);
		memcpy(l->root[l->n_roots].weight, hit.weight, sizeof hair->weight);
	}
}

/* Of eyes that look straight ahead and are shut, in that pose: roots that lie too far from the seam, which is the lower rim, are none. */
static void near_seam(struct lash *l, const struct hairs *h, const struct front *f, const struct poser *p)
{
	const struct hair *hair = &h->hair[l->hair];
	for (int r = 1; r < l->n_roots; r++) {
		const struct hair there = at_root(hair, &l->root[r]);
		double root[3], least = INFINITY, over = 0;
		front_of(root, f, hair_frame_of(&there, p->rig, (const float(*)[3])p->x).root);
		for (int i = 0; i < h->n_rims; i++) {
			const struct hair_rim *rim = &h->rim[i];
			float at[3] = { 0 };
			double seam[3];
			for (int k = 0; k < 9; k++)
				at[k % 3] += rim->weight[0][k / 3] * p->x[rim->vertex[0][k / 3]][k % 3];
			front_of(seam, f, at);
			if (rim->side == hair->side && fabs(seam[0] - root[0]) < least) {
				least = fabs(seam[0] - root[0]);
				over = (root[1] - seam[1]) * (hair->kind == HAIR_UPPER ? 1 : -1);
			}
		}
		l->n_roots = over > off_seam[hair->kind] ? r : l->n_roots;
	}
}

/* Adds one pose, but for ways that are already worse than what is. */
static void count(struct lash *of, int n, const struct hairs *h, const struct poser *p)
{
#pragma omp parallel for schedule(dynamic, 8)
	for (int i = 0; i < n; i++)
		for (int r = 0; r < of[i].n_roots; r++) {
			const struct hair hair = at_root(&h->hair[of[i].hair], &of[i].root[r]);
			const struct hair_frame f = hair_frame_of(&hair, p->rig, (const float(*)[3])p->x);
			for (int way = 0; way < WAYS; way++) {
				float local[HAIR_LASH_POINTS][3];
				if (of[i].n[r][way] > of[i].poses)
					continue;
				turned(local, (const float(*)[3])h->local + hair.first, hair.n, way);
				of[i].n[r][way] += crossed_as((const float(*)[3])local, &hair, &f, p->skin);
			}
		}
}

/* How far from what it was. */
static float change(int root, int way)
{
	return off_by[way % OFF] + fabsf(up_by[way / OFF % UP]) + 4 * (1 - length_by[way / (OFF * UP)]) + 0.5f * (float)root_by[root];
}

static void choose(struct hairs *h, const struct lash *l)
{
	struct hair *hair = &h->hair[l->hair];
	float local[HAIR_LASH_POINTS][3];
	int best = 0, root = 0;
	for (int r = 0; r < l->n_roots; r++)
		for (int way = 0; way < WAYS; way++) {
			const int more = l->n[r][way] - l->n[root][best];
			if (more < 0 || (!more && change(r, way) < change(root, best))) {
				best = way;
				root = r;
			}
		}
	*hair = at_root(hair, &l->root[root]);
	turned(local, (const float(*)[3])h->local + hair->first, hair->n, best);
	memcpy(h->local + hair->first, local, (size_t)hair->n * sizeof *local);
}

void hairs_turn_out(struct hairs *h, const struct front front[2], struct ray_scene *skin)
{
	const struct rig *rig = front->rig;
	struct poser p = { rig, deform_new(rig), deform_near_of(rig), mem_new((size_t)rig->n + 1, sizeof *p.x), mem_new((size_t)rig->n_inputs + 1, sizeof *p.c), skin };
	struct lash *of = mem_new((size_t)h->n + 1, sizeof *of);
	deform_rest(p.deform, p.x, 0);
	const int n = find_crossed(of, h, &p);
	ray_scene_move(skin, (const float(*)[3])rig->rest);
	for (int i = 0; i < n; i++)
		find_roots(&of[i], &h->hair[of[i].hair], &front[h->hair[of[i].hair].side]);
	pose(&p, 0, 0, 0);
	for (int i = 0; i < n; i++)
		near_seam(&of[i], h, &front[h->hair[of[i].hair].side], &p);
	for (int k = 0; k < POSES && n; k++) {
		pose_of(&p, k);
		count(of, n, h, &p);
	}
	for (int i = 0; i < n; i++)
		choose(h, &of[i]);
	free(of);
	free(p.c);
	free(p.x);
	deform_near_free(&p.near);
	deform_free(p.deform);
}
