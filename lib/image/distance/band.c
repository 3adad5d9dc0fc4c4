/* The exact distance field in a band. Along each column the distance to the nearest edge of skin (columns.c); then along
 * each row the minimum over the columns (rows.c). Both passes are exact (separability of the squared distance: Saito and
 * Toriwaki 1994), and visit only blocks of texels that hold globe and lie near skin. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "image/distance/impl.h"
#include "math/simd.h"

enum { LANES = DISTANCE_LANES, GROUP = DISTANCE_GROUP, TEXELS = GROUP * LANES };

/* Contents of sixteen texels; a material is one bit, or none. */
static uint8_t holds(const uint8_t m[LANES])
{
	_Static_assert(DISTANCE_OTHER == 0 && DISTANCE_GLOBE == 1 && DISTANCE_SKIN == 2, "one bit each");
	const uint64_t globe = DISTANCE_EACH * DISTANCE_GLOBE, skin = DISTANCE_EACH * DISTANCE_SKIN;
	uint64_t a, b;
	memcpy(&a, m, sizeof a);
	memcpy(&b, m + sizeof a, sizeof b);
	return (uint8_t)(((a | b) & globe ? DISTANCE_HAS_GLOBE : 0) | ((a | b) & skin ? DISTANCE_HAS_SKIN : 0)
	                 | ((a & b & skin) == skin ? DISTANCE_ALL_SKIN : 0) | ((a & b & globe) == globe ? DISTANCE_ALL_GLOBE : 0));
}

/* True where n texels, a multiple of eight, are all of one material. */
SIMD_INLINE bool uniform(const uint8_t *m, int n)
{
	uint64_t first = DISTANCE_EACH * m[0], other = 0;
	for (int i = 0; i < n; i += 8) {
		uint64_t word;
		memcpy(&word, m + i, sizeof word);
		other |= word ^ first;
	}
	return !other;
}

/* Contents of n groups of blocks; returns the union of their bits. */
SIMD_INLINE uint8_t mark(uint8_t *restrict has, const uint8_t *restrict m, int n)
{
	uint8_t all = 0;
	if (uniform(m, n * TEXELS)) {
		memset(has, holds(m), (size_t)n * GROUP);
		return has[0];
	}
	for (int k = 0; k < n * GROUP; k++)
		all |= has[k] = holds(m + k * LANES);
	return all;
}

/* Contents of the groups of a row; true where any holds globe. Most of a screen is of one material. */
SIMD_CLONES static bool mark_row(uint8_t *restrict has, const uint8_t *restrict material, int width)
{
	enum { SPAN = 4 };
	uint8_t all = 0, cut[TEXELS] = { 0 };
	int n = width / TEXELS, rest = width - n * TEXELS, k = 0;
	for (; k + SPAN <= n; k += SPAN)
		all |= mark(has + k * GROUP, material + k * TEXELS, SPAN);
	for (; k < n; k++)
		all |= mark(has + k * GROUP, material + k * TEXELS, 1);
	if (rest) {
		memcpy(cut, material + n * TEXELS, (size_t)rest);
		all |= mark(has + n * GROUP, cut, 1);
	}
	return all & DISTANCE_HAS_GLOBE;
}

/* The largest distance in px to which `reach` projects anywhere on the globe. */
static double reach_px(const struct distance_scene *s, double reach)
{
	double nearest = INFINITY;
	if (!s->depth)
		return reach;
#pragma omp parallel for reduction(min : nearest)
	for (int y = 0; y < s->height; y++)
		for (size_t i = (size_t)y * (size_t)s->width; i < (size_t)(y + 1) * (size_t)s->width; i++)
			if (s->material[i] == DISTANCE_GLOBE && s->depth[i] > 0 && (double)s->depth[i] < nearest)
				nearest = s->depth[i];
	return reach * s->focal_px / nearest;
}

/* Sets the window: the groups that hold globe, widened by the band. False: there is no globe. */
static bool window(struct distance_field *f, const uint8_t *globe, double reach)
{
	const struct distance_scene *s = f->scene;
	int far = s->width > s->height ? s->width : s->height, top = s->height, bottom = -1, groups = f->blocks / GROUP;
	int from = groups, to = 0;  // groups that hold globe
	for (int y = 0; y < s->height; y++) {
		if (!globe[y])
			continue;
		const uint8_t *has = distance_has(f, y);
		top = top < y ? top : y;
		bottom = y;
		for (int k = 0; k < from; k++)
			if (distance_group(has + k * GROUP) & DISTANCE_EACH * DISTANCE_HAS_GLOBE)
				from = k;
		for (int k = groups; k > to; k--)
			if (distance_group(has + (k - 1) * GROUP) & DISTANCE_EACH * DISTANCE_HAS_GLOBE)
				to = k;
	}
	if (bottom < 0)
		return false;
	double px = ceil(reach_px(s, reach));
	f->band = px < far ? (int)px : far;
	int more = (f->band + 3 + TEXELS) / (TEXELS), end = bottom + 1 + f->band;
	f->first = from > more ? (from - more) * GROUP : 0;
	f->last = (to + more < groups ? to + more : groups) * GROUP;
	f->wide = (f->band + 3 + LANES) / LANES;
	f->pitch = f->last - f->first + 2 * f->wide;
	f->globe_y0 = top;
	f->globe_y1 = bottom + 1;
	f->y0 = top > f->band ? top - f->band : 0;
	f->rows = (end < s->height ? end : s->height) - f->y0;
	size_t n = (size_t)f->pitch * (size_t)f->rows;
	f->v = mem_array(n * LANES, sizeof *f->v);
	f->edge = mem_new(n, sizeof *f->edge);
	return true;
}

SIMD_CLONES static int globe_texels(const uint8_t *material, int n)
{
	int sum = 0;
#pragma omp simd reduction(+ : sum)
	for (int i = 0; i < n; i++)
		sum += material[i] == DISTANCE_GLOBE;
	return sum;
}

void distance_band(float *out, float (*nearest)[2], const struct distance_scene *s, double reach, struct distance_cost *cost)
{
	struct distance_field f = { .scene = s, .blocks = (s->width + TEXELS - 1) / (TEXELS) * GROUP };
	size_t width = (size_t)s->width;
	double reads = (double)s->width * s->height;
	f.has = mem_array((size_t)s->height * (size_t)f.blocks, sizeof *f.has);
	uint8_t *globe = mem_array((size_t)s->height, 1);
	bool any = false;
#pragma omp parallel reduction(+ : reads)
	{
#pragma omp for schedule(static)
		for (int y = 0; y < s->height; y++)
			globe[y] = mark_row(f.has + (size_t)y * (size_t)f.blocks, s->material + (size_t)y * width, s->width);
#pragma omp single
		any = window(&f, globe, reach);
#pragma omp for schedule(dynamic)
		for (int k = f.first / GROUP; k < (any ? f.last : f.first) / GROUP; k++)
			reads += distance_columns(&f, k);
#pragma omp for schedule(dynamic, 16)
		for (int y = f.globe_y0; y < (any ? f.globe_y1 : f.globe_y0); y++)
			reads += distance_row(&f, y, reach, out, nearest);
	}
	free(f.v);
	free(f.edge);
	free(f.has);
	free(globe);
	if (cost)
		*cost = (struct distance_cost){ globe_texels(s->material, s->width * s->height), reads };
}
