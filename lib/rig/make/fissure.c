/* The palpebral fissure as the modelling camera sees it: the pixels that skin covers in a pose, and the gap left open in each column. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "rig/make/make_impl.h"

bool rig_fissure_new(struct rig_fissure *f, const struct rig *rig, const struct rig_motion *m, int side, const double rim[2])
{
	double box[4] = { INFINITY, INFINITY, -INFINITY, -INFINITY };
	for (int i = 2 * side * m->n_points; i < 2 * (side + 1) * m->n_points; i++)
		for (int c = 0; c < 2 && isfinite(m->lid[i][c]); c++) {
			box[c] = fmin(box[c], m->lid[i][c]);
			box[c + 2] = fmax(box[c + 2], m->lid[i][c]);
		}
	if (!(box[2] > box[0]) || box[2] - box[0] > 1e4 || box[3] - box[1] > 1e4)
		return false;
	*f = (struct rig_fissure){ .x0 = (int)(box[0] - rim[0]), .y0 = (int)(box[1] - rim[1]), .width = (int)fmax(box[2] - box[0] + 2 * rim[0], 0) + 1,
		                       .height = (int)(box[3] - box[1] + 2 * rim[1]) + 1 };
	f->cover = mem_new((size_t)f->width * (size_t)f->height + 1, 1);
	f->at = mem_new((size_t)rig->n + 1, sizeof *f->at);
	f->top = mem_new((size_t)f->width + 1, sizeof *f->top);
	f->bottom = mem_new((size_t)f->width + 1, sizeof *f->bottom);
	return true;
}

void rig_fissure_free(struct rig_fissure *f)
{
	free(f->cover);
	free(f->at);
	free(f->top);
	free(f->bottom);
	*f = (struct rig_fissure){ 0 };
}

/* Whether a vertex is skin in front of the globe; that behind it lines the socket and does not cover the eye. */
static bool before_globe(const struct rig *rig, int i, int side)
{
	double z = 0;
	for (int c = 0; c < 3; c++)
		z += rig->head_from_target[2][c] * (rig->rest[i][c] - rig->globe[side].center[c]);
	return rig->part[i] == RIG_SKIN && rig->side[i] == side && z > 0.2 * rig->globe[side].radius;
}

static void cover_triangle(struct rig_fissure *f, const float a[2], const float b[2], const float c[2])
{
	float area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
	if (area == 0)
		return;
	int x0 = (int)fmaxf(floorf(fminf(fminf(a[0], b[0]), c[0])) - (float)f->x0, 0);
	int x1 = (int)fminf(ceilf(fmaxf(fmaxf(a[0], b[0]), c[0])) - (float)f->x0, (float)f->width - 1);
	int y0 = (int)fmaxf(floorf(fminf(fminf(a[1], b[1]), c[1])) - (float)f->y0, 0);
	int y1 = (int)fminf(ceilf(fmaxf(fmaxf(a[1], b[1]), c[1])) - (float)f->y0, (float)f->height - 1);
	for (int y = y0; y <= y1; y++)
		for (int x = x0; x <= x1; x++) {
			float p[2] = { (float)(f->x0 + x) + 0.5f, (float)(f->y0 + y) + 0.5f };
			float wa = ((c[0] - b[0]) * (p[1] - b[1]) - (c[1] - b[1]) * (p[0] - b[0])) / area;
			float wb = ((a[0] - c[0]) * (p[1] - c[1]) - (a[1] - c[1]) * (p[0] - c[0])) / area;
			if (wa >= -1e-4f && wb >= -1e-4f && wa + wb <= 1.0001f)
				f->cover[(long)y * f->width + x] = 1;
		}
}

/* A column that is shut lies where the nearest open one has its middle: what closes that one moves the skin beside it too. */
static void place_shut_columns(struct rig_fissure *f)
{
	int *from = mem_new((size_t)f->width + 1, sizeof *from), last = -1;
	for (int x = 0; x < f->width; x++)
		from[x] = last = f->bottom[x] > f->top[x] ? x : last;
	last = -1;
	for (int x = f->width - 1; x >= 0; x--) {
		last = from[x] == x ? x : last;
		if (last >= 0 && (from[x] < 0 || last - x < x - from[x]))
			from[x] = last;
	}
	for (int x = 0; x < f->width; x++)
		if (from[x] >= 0 && from[x] != x)
			f->top[x] = f->bottom[x] = 0.5f * (f->top[from[x]] + f->bottom[from[x]]);
	free(from);
}

void rig_fissure_look(struct rig_fissure *f, const struct rig *rig, int side, const double de[RIG_COMPONENTS])
{
	memset(f->cover, 0, (size_t)f->width * (size_t)f->height);
	for (int i = 0; i < rig->n; i++)
		for (int c = 0; c < 2; c++) {
			double px = rig->home[i][c];
			for (int k = 0; k < RIG_COMPONENTS; k++)
				px += rig->basis[i][c * RIG_COMPONENTS + k] * de[k];
			f->at[i][c] = (float)px;
		}
	for (int t = 0; t < rig->n_faces; t++) {
		const int32_t *v = rig->faces[t];
		if (before_globe(rig, v[0], side) && before_globe(rig, v[1], side) && before_globe(rig, v[2], side))
			cover_triangle(f, f->at[v[0]], f->at[v[1]], f->at[v[2]]);
	}
	for (int x = 0; x < f->width; x++) {
		// The longest gap between covered pixels: gaps at the window's border are not the fissure.
		int best = 0, at = 0, from = -1;
		for (int y = 0; y < f->height; y++) {
			if (!f->cover[(long)y * f->width + x])
				continue;
			if (from >= 0 && y - from - 1 > best) {
				best = y - from - 1;
				at = y;
			}
			from = y;
		}
		f->bottom[x] = (float)(f->y0 + at);
		f->top[x] = f->bottom[x] - (float)best;
	}
	place_shut_columns(f);
}
