#include "rig/glb/poses.h"

#include <math.h>
#include <stdlib.h>

#include "base/mem.h"
#include "rig/drive.h"
#include "rig/glb/halves.h"
#include "rig/glb/mixed.h"
#include "rig/glb/posed.h"
#include "rig/glb/turned.h"

/* A named pose as a target that others may be added to: on its eye's side of the face (of an expression, eye < 0, everywhere) what it differs by from a look
 * straight ahead, or a blink from rest: `from`; null: from the mesh itself. What all poses have in common with each other against the mesh (its lids'
 * linings lie in its eyeballs) is in the looks up and down alone, of which an eye has one at a time, or it would be there as often as there are targets. */
static void pose_target(float *out, const float *now, const float *from, int n, const struct poser *p, const int *vertex, const float (*at)[3], int eye)
{
	for (int i = 0; i < n; i++) {
		const float share = eye < 0 ? 1 : poser_own_side(p, eye, vertex ? p->rig->rest[vertex[i]] : at[i]);
		for (int c = 3 * i; c < 3 * i + 3; c++)
			out[c] = share * (now[c] - (from ? from[c] : 0));
	}
}

/* Controls of pose k. An eye's are posed with the other one doing the same, as people's do: what a clip never shows, one lid moving alone, would be
 * a guess, and take the other eye's lid along. */
static void pose_controls(double *c, const struct rig *rig, int k)
{
	static const double look[GLB_POSES][2] = { { 0, 0 }, { 0, 0 }, { 0, 20 }, { 0, 20 }, { 0, -20 }, { 0, -20 },
		                                       { -25, 0 }, { 25, 0 }, { 25, 0 }, { -25, 0 }, { 0, 0 }, { 0, 0 } };
	if (k < GLB_POSES) {
		drive_look(c, rig, look[k][0], look[k][1], k < 2 ? 0 : k >= 10 ? 1.3 : 1);
		return;
	}
	drive_look(c, rig, 0, 0, 1);
	drive_express(c, rig, k - GLB_POSES, 1, 1);
}

void glb_take_poses(struct glb_bake *b, struct poser *p, const struct glb_conf *conf)
{
	const size_t row = 3 * (size_t)b->n, hair = 3 * (size_t)b->n_hair;
	const size_t all = (size_t)(GLB_POSES + conf->n_expressions + glb_most_mixed(conf->n_expressions) + GLB_TURNED + GLB_HALVES);
	double *c = mem_new((size_t)p->rig->n_inputs + 1, sizeof *c), turn[2][3][3];
	struct posed still = posed_new(b), ahead = posed_new(b), now = posed_new(b);
	b->n_poses = (int)all;
	b->pose_name = mem_new(all, sizeof *b->pose_name);
	b->driven = mem_new(all, sizeof *b->driven);
	b->pose = mem_new(all * row + 1, sizeof *b->pose);
	b->pose_lean = mem_new(all * row + 1, sizeof *b->pose_lean);
	b->hair_pose = mem_new(all * hair + 1, sizeof *b->hair_pose);
	poser_still(p);
	posed_take(&still, p, b);
	drive_look(c, p->rig, 0, 0, 1);
	poser_pose(p, c, turn);
	posed_take(&ahead, p, b);
	for (int k = 0; k < b->n_poses; k++)
		b->driven[k] = (struct glb_driven){ -1, -1, false };
	for (int k = 0; k < GLB_POSES + conf->n_expressions; k++) {
		const int eye = k < GLB_POSES ? k % 2 : -1;
		const bool lifts = k >= 2 && k < 6;  // glb_pose_names
		const struct posed *from = k < 2 ? &still : &ahead;
		b->pose_name[k] = mem_str(k < GLB_POSES ? glb_pose_names[k] : conf->expression[k - GLB_POSES]);
		pose_controls(c, p->rig, k);
		poser_pose(p, c, turn);
		posed_take(&now, p, b);
		pose_target(b->pose + (size_t)k * row, now.x, lifts ? 0 : from->x, b->n, p, b->vertex, 0, eye);
		pose_target(b->pose_lean + (size_t)k * row, now.lean, lifts ? 0 : from->lean, b->n, p, b->vertex, 0, eye);
		pose_target(b->hair_pose + (size_t)k * hair, now.hair, lifts ? 0 : from->hair, b->n_hair, p, 0, (const float(*)[3])p->hair_rest, eye);
	}
	glb_take_halves(b, p);
	glb_take_turned(b, p);
	glb_take_mixed(b, p, conf->n_expressions);
	posed_free(&still);
	posed_free(&ahead);
	posed_free(&now);
	free(c);
}
