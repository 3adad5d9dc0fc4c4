/* turned_over RIG.npz: skin round shut eyes that turns over. One line of numbers a pose and side: expression (-1: none), its strength, how far eyes are shut,
 * side; mm^2 of skin seen from behind, by the front, orthographically; and faces of skin that lie 1.5 to 14 mm (of an eyeball of 12 mm) off the opening at rest, look at
 * the front there (cosine 0.25 at least) and away from it in the pose: how many, their area at rest, mm^2. Margins, which lids fold, are nearer than that. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "math/vec.h"
#include "rig/deform/arc.h"
#include "rig/deform/deform.h"
#include "rig/deform/lifted.h"
#include "rig/deform/opening.h"
#include "rig/drive.h"

enum { W = 960, H = 640 };
static const double step = 0.05;  // mm a pixel
static const double near_mm = 1.5, far_mm = 14, facing = 0.25;

/* What the front sees of one eye: depth; 1 where that is skin from behind. */
struct seen {
	double z[W * H];
	bool behind[W * H];
};

static void corners(double p[3][3], const struct rig *rig, int side, const float (*x)[3], const int32_t v[3])
{
	for (int k = 0; k < 3; k++)
		deform_in_head(p[k], rig, side, x[v[k]]);
}

/* The normal, of twice the face's area. */
static void across(double n[3], const double p[3][3])
{
	double a[3], b[3];
	vec_add(a, p[1], -1, p[0]);
	vec_add(b, p[2], -1, p[0]);
	vec_cross(n, a, b);
}

static void draw(struct seen *s, const double p[3][3], bool skin)
{
	double q[3][2];
	for (int k = 0; k < 3; k++) {
		q[k][0] = p[k][0] / step + W / 2;
		q[k][1] = H / 2 - p[k][1] / step;
	}
	const double area = (q[1][0] - q[0][0]) * (q[2][1] - q[0][1]) - (q[1][1] - q[0][1]) * (q[2][0] - q[0][0]);
	const int x0 = (int)fmax(floor(fmin(fmin(q[0][0], q[1][0]), q[2][0])), 0), x1 = (int)fmin(ceil(fmax(fmax(q[0][0], q[1][0]), q[2][0])), W - 1);
	const int y0 = (int)fmax(floor(fmin(fmin(q[0][1], q[1][1]), q[2][1])), 0), y1 = (int)fmin(ceil(fmax(fmax(q[0][1], q[1][1]), q[2][1])), H - 1);
	for (int y = y0; y <= y1 && area != 0; y++)
		for (int x = x0; x <= x1; x++) {
			double w[3], z = 0;
			w[0] = ((q[2][0] - q[1][0]) * (y + 0.5 - q[1][1]) - (q[2][1] - q[1][1]) * (x + 0.5 - q[1][0])) / area;
			w[1] = ((q[0][0] - q[2][0]) * (y + 0.5 - q[2][1]) - (q[0][1] - q[2][1]) * (x + 0.5 - q[2][0])) / area;
			w[2] = 1 - w[0] - w[1];
			for (int k = 0; k < 3; k++)
				z += w[k] * p[k][2];
			if (w[0] < -1e-9 || w[1] < -1e-9 || w[2] < -1e-9 || z <= s->z[y * W + x])
				continue;
			s->z[y * W + x] = z;
			s->behind[y * W + x] = skin && area > 0;
		}
}

static double seen_behind(struct seen *s, const struct rig *rig, int side, const float (*x)[3])
{
	int n = 0;
	for (int i = 0; i < W * H; i++) {
		s->z[i] = -1e9;
		s->behind[i] = false;
	}
	for (int f = 0; f < rig->n_faces; f++) {
		double p[3][3];
		corners(p, rig, side, x, rig->faces[f]);
		draw(s, (const double(*)[3])p, rig->part[rig->faces[f][0]] == RIG_SKIN);
	}
	for (int i = 0; i < W * H; i++)
		n += s->behind[i];
	return n * step * step;
}

/* How far off an eye's opening a place is as the front sees it, mm of an eyeball of 12 mm. */
static double off_opening(const struct rig *rig, const struct deform_opening *o, int side, const double p[3])
{
	double least = INFINITY;
	for (int i = o->first; i <= o->last; i++)
		least = fmin(least, hypot(p[0] - o->step * (i - DEFORM_COLUMNS / 2), fmax(fmax(p[1] - o->top[i], o->bottom[i] - p[1]), 0)));
	return 12 * least / rig->globe[side].radius;
}

/* Faces that are to look at the front. which: out, [n_faces]. Returns how many. */
static int find_lid(int *which, const struct rig *rig, const struct deform_near *near, int side)
{
	int n = 0;
	for (int f = 0; f < rig->n_faces; f++) {
		const int32_t *v = rig->faces[f];
		double p[3][3], normal[3];
		bool lid = true;
		corners(p, rig, side, (const float(*)[3])rig->rest, v);
		across(normal, (const double(*)[3])p);
		lid = normal[2] > facing * vec_norm(normal);
		for (int k = 0; k < 3 && lid; k++) {
			const double off = rig->part[v[k]] == RIG_SKIN && rig->side[v[k]] == side && p[k][2] > 0 ? off_opening(rig, &near->rest[side], side, p[k]) : 0;
			lid = off > near_mm && off < far_mm;
		}
		if (lid)
			which[n++] = f;
	}
	return n;
}

static int turned(double *mm2, const struct rig *rig, int side, int n, const int *which, const float (*x)[3])
{
	int all = 0;
	*mm2 = 0;
	for (int i = 0; i < n; i++) {
		double p[3][3], now[3], rest[3];
		corners(p, rig, side, x, rig->faces[which[i]]);
		across(now, (const double(*)[3])p);
		corners(p, rig, side, (const float(*)[3])rig->rest, rig->faces[which[i]]);
		across(rest, (const double(*)[3])p);
		*mm2 += now[2] < 0 ? 0.5 * vec_norm(rest) : 0;
		all += now[2] < 0;
	}
	return all;
}

int main(int argc, char **argv)
{
	static const double strengths[] = { 1, 0.5 }, shut[] = { 1, 0.75, 0.5 };
	struct rig rig = { 0 };
	struct err err = { 0 };
	if (argc != 2 || !rig_load(&rig, argv[1], &err)) {
		fprintf(stderr, "turned_over: %s\n", argc == 2 ? err.msg : "RIG.npz");
		return 2;
	}
	struct deform *deform = deform_new(&rig);
	struct deform_near near = deform_near_of(&rig);
	struct seen *s = mem_new(1, sizeof *s);
	float (*x)[3] = mem_new((size_t)rig.n + 1, sizeof *x);
	double *c = mem_new((size_t)rig.n_inputs + 1, sizeof *c);
	int *which[2], n[2];
	for (int side = 0; side < 2; side++) {
		which[side] = mem_new((size_t)rig.n_faces + 1, sizeof **which);
		n[side] = find_lid(which[side], &rig, &near, side);
	}
	deform_rest(deform, x, 0);
	printf("expression,strength,shut,side,seen_mm2,faces,faces_mm2,of\n");
	for (int k = -1; k < rig.n_inputs - SKIN_EYE_INPUTS; k++)
		for (int i = 0; i < (k < 0 ? 1 : COUNT(strengths)) * COUNT(shut); i++) {
			const double open = 1 - shut[i % COUNT(shut)], strength = k < 0 ? 0 : strengths[i / COUNT(shut)];
			double e[RIG_COMPONENTS], turn[2][3][3], lifted[2];
			drive_look(c, &rig, 0, 0, open);
			if (k >= 0)
				drive_express(c, &rig, k, strength, open);
			deform_lifted(lifted, &near, &rig, c);
			rig_components(e, &rig, c);
			rig_globes_turned(turn, &rig, c);
			deform_pose(deform, e, (const double(*)[3][3])turn, x, 0);
			deform_settle(x, &rig, &near, (const double(*)[3][3])turn, lifted);
			for (int side = 0; side < 2; side++) {
				double mm2;
				const int all = turned(&mm2, &rig, side, n[side], which[side], (const float(*)[3])x);
				printf("%d,%g,%g,%d,%.3f,%d,%.3f,%d\n", k, strength, 1 - open, side, seen_behind(s, &rig, side, (const float(*)[3])x), all, mm2, n[side]);
			}
		}
	free(c);
	free(x);
	free(s);
	free(which[0]);
	free(which[1]);
	deform_near_free(&near);
	deform_free(deform);
	rig_free(&rig);
	return fflush(stdout) != 0;
}
