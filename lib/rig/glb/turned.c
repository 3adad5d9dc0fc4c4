#include "rig/glb/turned.h"

#include <stdlib.h>

#include "base/mem.h"
#include "rig/drive.h"
#include "rig/glb/halves.h"

/* out = own now - blink - look */
static void lack(float *out, const float *now, const float *blink, const float *look, int n, const float *own)
{
	for (int i = 0; i < 3 * n; i++)
		out[i] = own[i / 3] * now[i] - blink[i] - look[i];
}

void glb_take_turned(struct glb_bake *b, struct poser *p)
{
	static const double up[GLB_TURNED_LOOKS] = { -20, -20, 20, 20 };  // as the looks' targets are
	const size_t row = 3 * (size_t)b->n, hairs = 3 * (size_t)b->n_hair, first = (size_t)(b->n_poses - GLB_HALVES - GLB_TURNED);
	double *c = mem_new((size_t)p->rig->n_inputs + 1, sizeof *c), turn[2][3][3];
	float *x = mem_array(row + 1, sizeof *x), *n = mem_array(row + 1, sizeof *n), *h = mem_array(hairs + 1, sizeof *h);
	float *own = mem_array((size_t)b->n + 1, sizeof *own), *own_hair = mem_array((size_t)b->n_hair + 1, sizeof *own_hair);
	for (int k = 0; k < GLB_TURNED_LOOKS; k++) {
		const size_t eye = (size_t)k % 2, look = (size_t)glb_turned_look(k), at = first + (size_t)k;
		for (int i = 0; i < b->n; i++)
			own[i] = poser_own_side(p, (int)eye, p->rig->rest[b->vertex[i]]);
		for (int i = 0; i < b->n_hair; i++)
			own_hair[i] = poser_own_side(p, (int)eye, p->hair_rest[i]);
		drive_look(c, p->rig, 0, up[k], 0);
		poser_pose(p, c, turn);
		poser_skin(x, n, p, b->n, b->vertex);
		poser_hair(h, p);
		b->pose_name[at] = mem_str(glb_turned_names[k]);
		b->driven[at] = (struct glb_driven){ (int)eye, (int)look, false };
		lack(b->pose + at * row, x, b->pose + eye * row, b->pose + look * row, b->n, own);
		lack(b->pose_lean + at * row, n, b->pose_lean + eye * row, b->pose_lean + look * row, b->n, own);
		lack(b->hair_pose + at * hairs, h, b->hair_pose + eye * hairs, b->hair_pose + look * hairs, b->n_hair, own_hair);
		// The blink's whole way from that look, and what leads it round: beyond what does so straight ahead.
		const size_t way = at + GLB_TURNED_LOOKS;
		const float *half = b->pose + ((size_t)(b->n_poses - GLB_HALVES) + eye) * row;
		for (size_t i = 0; i < row; i++)
			x[i] = b->pose[eye * row + i] + b->pose[at * row + i];
		glb_lead_round(b->pose + way * row, half, p, b, b->pose + look * row, x, (int)eye);
		b->pose_name[way] = mem_str(glb_turned_names[k + GLB_TURNED_LOOKS]);
		b->driven[way] = (struct glb_driven){ (int)eye, (int)look, true };
	}
	free(c);
	free(x);
	free(n);
	free(h);
	free(own);
	free(own_hair);
}
