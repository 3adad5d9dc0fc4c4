#include "rig/glb/mixed.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "rig/drive.h"
#include "rig/glb/halves.h"
#include "rig/glb/posed.h"

static const double rests_mm = 0.02, rests_lean = 0.02;  // a vertex that moves and turns by less is left where it is: no margin and no fold shows it
static const double needed_mm = 0.1;                     // a target that moves no skin by more, or a way that goes no deeper, needs none: margins are arcs to 0.12 mm

/* out = own (now - still - expression) - blink: a blink's target is told against `still`, and has its own side already */
static void lack(float *out, const float *now, const float *still, const float *blink, const float *expression, int n, const float *own)
{
	for (int i = 0; i < 3 * n; i++)
		out[i] = own[i / 3] * (now[i] - still[i] - expression[i]) - blink[i];
}

/* Leaves vertices alone that hardly move. lean: null: hairs. */
static void settle(float *x, float *lean, int n)
{
	for (int i = 0; i < n; i++) {
		const float *d = x + 3 * i, *t = lean ? lean + 3 * i : 0;
		const double by = sqrt((double)d[0] * d[0] + (double)d[1] * d[1] + (double)d[2] * d[2]);
		const double turned = t ? sqrt((double)t[0] * t[0] + (double)t[1] * t[1] + (double)t[2] * t[2]) : 0;
		for (int c = 3 * i; c < 3 * i + 3 && by < rests_mm && turned < rests_lean; c++) {
			x[c] = 0;
			if (lean)
				lean[c] = 0;
		}
	}
}

/* Both eyes' way of a blink with that expression: what its first target lacks is at `mixed`, and one behind it the other eye's. way: [3 b->n] out; returns the blink's half, which goes along. */
static const float *way_of(float *way, const struct glb_bake *b, int eye, int mixed)
{
	const size_t row = 3 * (size_t)b->n;
	const float *blink = b->pose + (size_t)eye * row, *more = b->pose + (size_t)(mixed + eye) * row;
	for (size_t i = 0; i < row; i++)
		way[i] = blink[i] + more[i];
	return b->pose + ((size_t)(b->n_poses - GLB_HALVES) + (size_t)eye) * row;
}

/* Fills what leads them round the eye with that expression, beyond what does so without: two poses behind what they lack. Nothing where that suffices. */
static void lead_round(struct glb_bake *b, struct poser *p, int expression, int mixed)
{
	const size_t row = 3 * (size_t)b->n;
	const float *from = b->pose + (size_t)expression * row;
	float *way = mem_array(row + 1, sizeof *way);
	double most = 0;
	for (int eye = 0; eye < 2; eye++) {
		const float *half = way_of(way, b, eye, mixed);
		most = fmax(most, glb_way_lacks(half, p, b, from, way, eye));
	}
	for (int eye = 0; eye < 2 && most > needed_mm; eye++) {
		const float *half = way_of(way, b, eye, mixed);
		glb_lead_round(b->pose + (size_t)(mixed + 2 + eye) * row, half, p, b, from, way, eye);
	}
	free(way);
}

static bool has(const struct glb_bake *b, int but, const char *name)
{
	for (int k = 0; k < b->n_poses; k++)
		if (k != but && b->pose_name[k] && !strcmp(b->pose_name[k], name))
			return true;
	return false;
}

/* Says what a pose is. Expressions are named by whoever films: one may be called "down". */
static void name_it(struct glb_bake *b, int pose, int eye, int expression, bool half)
{
	char *name = mem_printf("%s_%s%s", glb_pose_names[eye], b->pose_name[expression], half ? "_half" : "");
	while (has(b, pose, name)) {
		char *longer = mem_printf("%s_too", name);
		free(name);
		name = longer;
	}
	b->pose_name[pose] = name;
	b->driven[pose] = (struct glb_driven){ eye, expression, half };
}

/* Whether the skin of either eye moves by what is worth a target. */
static bool needed(const struct glb_bake *b, int pair)
{
	const float *x = b->pose + 3 * (size_t)pair * (size_t)b->n;
	for (int i = 0; i < 2 * b->n; i++)
		if (hypot(hypot((double)x[3 * i], (double)x[3 * i + 1]), (double)x[3 * i + 2]) > needed_mm)
			return true;
	return false;
}

/* Takes two poses out of the bake: those behind them come forward. */
static void drop(struct glb_bake *b, int pair)
{
	const size_t row = 3 * (size_t)b->n, hair = 3 * (size_t)b->n_hair, at = (size_t)pair, from = at + 2, behind = (size_t)b->n_poses - from;
	free(b->pose_name[at]);
	free(b->pose_name[at + 1]);
	memmove(b->pose_name + at, b->pose_name + from, behind * sizeof *b->pose_name);
	memmove(b->driven + at, b->driven + from, behind * sizeof *b->driven);
	memmove(b->pose + at * row, b->pose + from * row, behind * row * sizeof *b->pose);
	memmove(b->pose_lean + at * row, b->pose_lean + from * row, behind * row * sizeof *b->pose_lean);
	memmove(b->hair_pose + at * hair, b->hair_pose + from * hair, behind * hair * sizeof *b->hair_pose);
	b->n_poses -= 2;
}

void glb_take_mixed(struct glb_bake *b, struct poser *p, int n)
{
	double *c = mem_new((size_t)p->rig->n_inputs + 1, sizeof *c), turn[2][3][3];
	float *own = mem_array((size_t)b->n + 1, sizeof *own), *own_hair = mem_array((size_t)b->n_hair + 1, sizeof *own_hair);
	struct posed still = posed_new(b), now = posed_new(b);
	const int first = GLB_POSES + n;
	poser_still(p);
	posed_take(&still, p, b);
	for (int k = 0; k < n; k++) {
		const int expression = GLB_POSES + k, at = first + 4 * k;
		const struct posed by = posed_of(b, expression);
		drive_look(c, p->rig, 0, 0, 0);
		drive_express(c, p->rig, k, 1, 0);
		poser_pose(p, c, turn);
		posed_take(&now, p, b);
		for (int eye = 0; eye < 2; eye++) {
			const struct posed blink = posed_of(b, eye), out = posed_of(b, at + eye);
			for (int i = 0; i < b->n; i++)
				own[i] = poser_own_side(p, eye, p->rig->rest[b->vertex[i]]);
			for (int i = 0; i < b->n_hair; i++)
				own_hair[i] = poser_own_side(p, eye, p->hair_rest[i]);
			lack(out.x, now.x, still.x, blink.x, by.x, b->n, own);
			lack(out.lean, now.lean, still.lean, blink.lean, by.lean, b->n, own);
			lack(out.hair, now.hair, still.hair, blink.hair, by.hair, b->n_hair, own_hair);
			settle(out.x, out.lean, b->n);
			settle(out.hair, 0, b->n_hair);
			name_it(b, at + eye, eye, expression, false);
			name_it(b, at + 2 + eye, eye, expression, true);
		}
		lead_round(b, p, expression, at);
	}
	for (int pair = first + glb_most_mixed(n) - 2; pair >= first; pair -= 2)
		if (!needed(b, pair))
			drop(b, pair);
	free(c);
	free(own);
	free(own_hair);
	posed_free(&still);
	posed_free(&now);
}
