/* lids: measures a driven character's lids on its mesh, seen orthographically from the front.
 *   lids RIG.npz [FOLDER]   one line of numbers a pose and side on stdout; FOLDER: a picture of each pose, PGM, the eyeball white
 * open_mm2  area of the eyeball that is seen
 * bend_mm   how far the upper margin leaves the nearer of its convex and its concave hull: 0 where its curvature has one sign
 * inside_mm least distance of the skin from the turned eyeball; below 0: inside */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "math/vec.h"
#include "rig/deform/clear.h"
#include "rig/deform/deform.h"
#include "rig/drive.h"

enum { W = 480, H = 320 };
static const double step = 0.1;  // mm a pixel

/* What is seen of one eye: depth and the face there, -1: none. */
struct seen {
	double z[W * H];
	int face[W * H];
};

static void into_head(double out[3], const struct rig *rig, int side, const float x[3])
{
	double d[3];
	for (int c = 0; c < 3; c++)
		d[c] = x[c] - rig->globe[side].center[c];
	mat_vec(out, rig->head_from_target, d);
}

static void draw(struct seen *s, int face, const double p[3][3])
{
	double q[3][2], area;
	for (int k = 0; k < 3; k++) {
		q[k][0] = p[k][0] / step + W / 2;
		q[k][1] = H / 2 - p[k][1] / step;
	}
	area = (q[1][0] - q[0][0]) * (q[2][1] - q[0][1]) - (q[1][1] - q[0][1]) * (q[2][0] - q[0][0]);
	if (area == 0)
		return;
	int x0 = (int)fmax(floor(fmin(fmin(q[0][0], q[1][0]), q[2][0])), 0), x1 = (int)fmin(ceil(fmax(fmax(q[0][0], q[1][0]), q[2][0])), W - 1);
	int y0 = (int)fmax(floor(fmin(fmin(q[0][1], q[1][1]), q[2][1])), 0), y1 = (int)fmin(ceil(fmax(fmax(q[0][1], q[1][1]), q[2][1])), H - 1);
	for (int y = y0; y <= y1; y++)
		for (int x = x0; x <= x1; x++) {
			double px = x + 0.5, py = y + 0.5, w[3], z = 0;
			w[0] = ((q[2][0] - q[1][0]) * (py - q[1][1]) - (q[2][1] - q[1][1]) * (px - q[1][0])) / area;
			w[1] = ((q[0][0] - q[2][0]) * (py - q[2][1]) - (q[0][1] - q[2][1]) * (px - q[2][0])) / area;
			w[2] = 1 - w[0] - w[1];
			if (w[0] < -1e-9 || w[1] < -1e-9 || w[2] < -1e-9)
				continue;
			for (int k = 0; k < 3; k++)
				z += w[k] * p[k][2];
			if (z > s->z[y * W + x]) {
				s->z[y * W + x] = z;
				s->face[y * W + x] = face;
			}
		}
}

static void look(struct seen *s, const struct rig *rig, int side, const float (*x)[3])
{
	for (int i = 0; i < W * H; i++) {
		s->z[i] = -1e9;
		s->face[i] = -1;
	}
	for (int f = 0; f < rig->n_faces; f++) {
		double p[3][3];
		for (int k = 0; k < 3; k++)
			into_head(p[k], rig, side, x[rig->faces[f][k]]);
		draw(s, f, (const double(*)[3])p);
	}
}

/* Largest distance of a chain below its upper hull; y: [n], NAN where there is none. */
static double below_hull(int n, const double *y)
{
	double worst = 0;
	for (int i = 0; i < n; i++)
		for (int a = 0; a < i && isfinite(y[i]); a++)
			for (int b = i + 1; b < n && isfinite(y[a]); b++)
				if (isfinite(y[b]))
					worst = fmax(worst, y[a] + (y[b] - y[a]) * (i - a) / (b - a) - y[i]);
	return worst;
}

static double bend_of(const struct seen *s, const struct rig *rig)
{
	double y[W], down[W];
	for (int x = 0; x < W; x++) {
		y[x] = down[x] = NAN;
		for (int k = 0; k < H && isnan(y[x]); k++)
			if (s->face[k * W + x] >= 0 && rig_is_globe(rig->part[rig->faces[s->face[k * W + x]][0]]))
				y[x] = -step * k;
		down[x] = -y[x];
	}
	return fmin(below_hull(W, y), below_hull(W, down));
}

static void picture(const char *folder, const char *name, const struct seen *s, const struct rig *rig)
{
	char path[4096];
	snprintf(path, sizeof path, "%s/%s.pgm", folder, name);
	FILE *f = fopen(path, "wb");
	if (!f)
		return;
	fprintf(f, "P5 %d %d 255\n", W, H);
	for (int i = 0; i < W * H; i++) {
		double gx = i % W ? (s->z[i] - s->z[i - 1]) / step : 0, gy = i >= W ? (s->z[i] - s->z[i - W]) / step : 0;
		bool globe = s->face[i] >= 0 && rig_is_globe(rig->part[rig->faces[s->face[i]][0]]);
		double light = globe ? 255 : 40 + 160 * (1 - 0.5 * gx + 0.7 * gy) / sqrt(1 + gx * gx + gy * gy) / 1.4;
		fputc((int)fmin(fmax(light, 0), 255), f);
	}
	fclose(f);
}

int main(int argc, char **argv)
{
	struct rig rig = { 0 };
	struct err err = { 0 };
	if (argc < 2 || !rig_load(&rig, argv[1], &err)) {
		fprintf(stderr, "lids: %s\n", argc < 2 ? "lids RIG.npz [FOLDER]" : err.msg);
		return 1;
	}
	struct deform *deform = deform_new(&rig);
	struct deform_near near = deform_near_of(&rig);
	struct seen *s = mem_new(1, sizeof *s);
	float (*x)[3] = mem_new((size_t)rig.n + 1, sizeof *x);
	double *c = mem_new((size_t)rig.n_inputs + 1, sizeof *c);
	static const double across[] = { -20, 0, 20 }, up[] = { 15, 0, -15, -25 }, open[] = { 1, 0.5, 0 };
	puts("h_deg,v_deg,aperture,side,open_mm2,bend_mm,inside_mm");
	for (int o = 0; o < COUNT(open); o++)
		for (int v = 0; v < COUNT(up); v++)
			for (int h = 0; h < COUNT(across); h++) {
				double e[RIG_COMPONENTS], turn[2][3][3];
				drive_look(c, &rig, across[h], up[v], open[o]);
				rig_components(e, &rig, c);
				rig_globes_turned(turn, &rig, c);
				deform_rest(deform, x, 0);
				deform_pose(deform, e, (const double(*)[3][3])turn, x, 0);
				deform_clear(x, &rig, &near, (const double(*)[3][3])turn);
				for (int side = 0; side < 2; side++) {
					double least = INFINITY;
					int n = 0;
					for (int i = 0; i < rig.n; i++)
						if (!rig_is_globe(rig.part[i]) && rig.side[i] == side)
							least = fmin(least, rig_globe_distance(&rig, side, (const double(*)[3])turn[side], x[i]));
					look(s, &rig, side, (const float(*)[3])x);
					for (int i = 0; i < W * H; i++)
						n += s->face[i] >= 0 && rig_is_globe(rig.part[rig.faces[s->face[i]][0]]);
					printf("%g,%g,%g,%d,%.2f,%.2f,%.3f\n", across[h], up[v], open[o], side, n * step * step, bend_of(s, &rig), least);
					char name[64];
					snprintf(name, sizeof name, "%g_%g_%g_%d", across[h], up[v], open[o], side);
					if (argc > 2)
						picture(argv[2], name, s, &rig);
				}
			}
	free(c);
	free(x);
	free(s);
	deform_near_free(&near);
	deform_free(deform);
	rig_free(&rig);
	return fflush(stdout) != 0;
}
