/* lashes: how far from the seam of shut lids lashes have their roots, seen from the front.
 *   lashes RIG.npz LASHES MARGIN_MM    (so many on an upper lid; breadth of its margin: render.lashes, render.lid_margin_mm)
 * One line a lid on stdout: of roots in tenths of the opening, inner corner first, the median distance over the seam (of a lower lid: under it), mm of an eyeball
 * of 12 mm; then the worst. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "base/mem.h"
#include "math/stats.h"
#include "math/vec.h"
#include "rig/deform/arc.h"
#include "rig/deform/deform.h"
#include "rig/drive.h"
#include "rig/hair/hair.h"

enum { TENTHS = 10 };

/* x outwards, y up, about the eyeball's centre, mm of an eyeball of 12 mm. */
static void front(double out[2], const struct rig *rig, int side, const float x[3])
{
	double d[3], head[3];
	for (int c = 0; c < 3; c++)
		d[c] = x[c] - rig->globe[side].center[c];
	mat_vec(head, rig->head_from_target, d);
	out[0] = (side ? -1 : 1) * head[0] * 12 / rig->globe[side].radius;
	out[1] = head[1] * 12 / rig->globe[side].radius;
}

static void of_rim(float out[3], const struct hair_rim *rim, const float (*x)[3])
{
	for (int c = 0; c < 3; c++) {
		out[c] = 0;
		for (int k = 0; k < 3; k++)
			out[c] += rim->weight[0][k] * x[rim->vertex[0][k]][c];
	}
}

/* Height of the lower rim at x, and where that is, 0 .. 1; beyond the corners theirs. */
static double seam_at(double *along, const struct hairs *h, const struct rig *rig, int side, const float (*pose)[3], double x)
{
	double least = INFINITY, y = NAN;
	for (int i = 0; i < h->n_rims; i++) {
		float at[3];
		double p[2];
		if (h->rim[i].side != side)
			continue;
		of_rim(at, &h->rim[i], pose);
		front(p, rig, side, at);
		if (fabs(p[0] - x) < least) {
			least = fabs(p[0] - x);
			y = p[1];
			*along = h->rim[i].along;
		}
	}
	return y;
}

static void lid(const struct hairs *h, const struct rig *rig, int side, int kind, const float (*pose)[3])
{
	double *off = mem_new((size_t)h->n + 1, sizeof *off), worst = -INFINITY;
	printf("%s %s", side ? "right" : "left", kind == HAIR_UPPER ? "upper" : "lower");
	for (int tenth = 0; tenth < TENTHS; tenth++) {
		int n = 0;
		for (int i = 0; i < h->n; i++) {
			double root[2], along = 0;
			if (h->hair[i].side != side || h->hair[i].kind != kind)
				continue;
			front(root, rig, side, hair_frame_of(&h->hair[i], rig, pose).root);
			const double over = (root[1] - seam_at(&along, h, rig, side, pose, root[0])) * (kind == HAIR_UPPER ? 1 : -1);
			if ((int)fmin(along * TENTHS, TENTHS - 1) == tenth)
				worst = fmax(worst, off[n++] = over);
		}
		printf(" %.2f", n ? stats_median(n, off) : NAN);
	}
	printf(" worst %.2f\n", worst);
	free(off);
}

int main(int argc, char **argv)
{
	struct rig rig;
	struct hairs hairs;
	struct err err = { 0 };
	double turn[2][3][3], e[RIG_COMPONENTS];
	if (argc != 4)
		return 2;
	if (!rig_load(&rig, argv[1], &err)) {
		fprintf(stderr, "lashes: %s\n", err.msg);
		return 1;
	}
	hairs_grow(&hairs, &rig, 0, &(struct hair_conf){ .lash_mm = 9, .brow_mm = 0, .lashes = atoi(argv[2]), .brow_hairs = 0, .margin_mm = atof(argv[3]) });
	struct deform *deform = deform_new(&rig);
	struct deform_near near = deform_near_of(&rig);
	float (*x)[3] = mem_new((size_t)rig.n + 1, sizeof *x);
	double *c = mem_new((size_t)rig.n_inputs + 1, sizeof *c);
	drive_look(c, &rig, 0, 0, 0);
	rig_components(e, &rig, c);
	rig_globes_turned(turn, &rig, c);
	deform_rest(deform, x, 0);
	deform_pose(deform, e, (const double(*)[3][3])turn, x, 0);
	deform_settle(x, &rig, &near, (const double(*)[3][3])turn, 0);
	for (int side = 0; side < 2; side++)
		for (int kind = HAIR_UPPER; kind <= HAIR_LOWER; kind++)
			lid(&hairs, &rig, side, kind, (const float(*)[3])x);
	free(x);
	free(c);
	deform_near_free(&near);
	deform_free(deform);
	hairs_free(&hairs);
	rig_free(&rig);
	return 0;
}
