#include "rig/hair/hair.h"

#include <math.h>
#include <stdlib.h>

#include "math/vec.h"

struct hair_frame hair_frame_of(const struct hair *h, const struct rig *rig, const float (*x)[3])
{
	struct hair_frame f = { 0 };
	float across[3];
	const float turn = h->side ? -1 : 1;
	for (int c = 0; c < 3; c++) {
		for (int k = 0; k < 3; k++)
			f.root[c] += h->weight[k] * x[h->vertex[k]][c];
		f.off[c] = f.root[c] - (float)rig->globe[h->side].center[c];
		across[c] = turn * (float)rig->head_from_target[0][c];
	}
	vecf_unit(f.off);
	vecf_cross(f.up, f.off, across);
	for (int c = 0; c < 3; c++)
		f.up[c] *= turn;
	vecf_unit(f.up);
	vecf_cross(f.along, f.up, f.off);
	for (int c = 0; c < 3; c++)
		f.along[c] *= turn;
	return f;
}

void hair_place(float (*out)[3], const struct hairs *all, const struct hair *h, const struct rig *rig, const float (*x)[3])
{
	const struct hair_frame f = hair_frame_of(h, rig, x);
	for (int k = 0; k < h->n; k++) {
		const float *l = all->local[h->first + k];
		for (int c = 0; c < 3; c++)
			out[k][c] = f.root[c] + l[0] * f.off[c] + l[1] * f.along[c] + l[2] * f.up[c];
	}
}

int hair_cell(const struct hair_film *film, int side, const double at[2])
{
	const double unit = film->radius / 12;
	const double i = rint(((side ? -1 : 1) * (at[0] - film->eye[side][0]) / unit - HAIR_FROM_X) / HAIR_CELL);
	const double j = rint(((at[1] - film->eye[side][1]) / unit - HAIR_FROM_Y) / HAIR_CELL);
	return i >= 0 && j >= 0 && i < HAIR_CELLS_X && j < HAIR_CELLS_Y ? (int)j * HAIR_CELLS_X + (int)i : -1;
}

void hairs_free(struct hairs *h)
{
	free(h->hair);
	free(h->local);
	free(h->rim);
	*h = (struct hairs){ 0 };
}
