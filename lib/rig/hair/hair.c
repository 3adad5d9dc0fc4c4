#include "rig/hair/hair.h"

#include <math.h>
#include <stdlib.h>

static void unit(float v[3])
{
	const float len = sqrtf(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]) + 1e-12f;
	for (int c = 0; c < 3; c++)
		v[c] /= len;
}

static void cross(float out[3], const float a[3], const float b[3])
{
	out[0] = a[1] * b[2] - a[2] * b[1];
	out[1] = a[2] * b[0] - a[0] * b[2];
	out[2] = a[0] * b[1] - a[1] * b[0];
}

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
	unit(f.off);
	cross(f.up, f.off, across);
	for (int c = 0; c < 3; c++)
		f.up[c] *= turn;
	unit(f.up);
	cross(f.along, f.up, f.off);
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

void hairs_free(struct hairs *h)
{
	free(h->hair);
	free(h->local);
	*h = (struct hairs){ 0 };
}
