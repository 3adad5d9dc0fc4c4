#include "image/scales.h"

#include <stdlib.h>

#include "base/mem.h"
#include "math/simd.h"

enum { CELL = 1 << (SCALES_LEVELS - 1), SPARE = 16 };

/* 1 2 1 along a row of bytes. */
SIMD_CLONES static void row_of_bytes(float *restrict out, const uint8_t *restrict in, int n)
{
	out[0] = 0.25f * (float)(3 * in[0] + in[n > 1]);
	SIMD_LOOP
	for (int x = 1; x < n - 1; x++)
		out[x] = 0.25f * (float)(in[x - 1] + 2 * in[x] + in[x + 1]);
	if (n > 1)
		out[n - 1] = 0.25f * (float)(in[n - 2] + 3 * in[n - 1]);
}

SIMD_CLONES static void row_of_floats(float *restrict out, const float *restrict in, int n)
{
	out[0] = 0.25f * (3 * in[0] + in[n > 1]);
	SIMD_LOOP
	for (int x = 1; x < n - 1; x++)
		out[x] = 0.25f * (in[x - 1] + 2 * in[x] + in[x + 1]);
	if (n > 1)
		out[n - 1] = 0.25f * (in[n - 2] + 3 * in[n - 1]);
}

SIMD_CLONES static void halve(float *restrict out, const float *restrict a, const float *restrict b, int n)
{
	SIMD_LOOP
	for (int x = 0; x < n; x++)
		out[x] = 0.25f * (a[2 * x] + a[2 * x + 1] + b[2 * x] + b[2 * x + 1]);
}

SIMD_CLONES static void weighted(float *restrict out, const float *restrict a, const float *restrict b, const float *restrict c, int n)
{
	SIMD_LOOP
	for (int x = 0; x < n; x++)
		out[x] = 0.25f * (a[x] + 2 * b[x] + c[x]);
}

/* 1 2 1 along columns, in place; the first and last rows are repeated outwards. */
static void down(struct scale_level *l, float *row)
{
	float *above = row, *keep = row + l->stride;
	for (int x = 0; x < l->width; x++)
		above[x] = l->px[x];
	for (int y = 0; y < l->height; y++) {
		float *here = l->px + (long)y * l->stride;
		const float *below = y + 1 < l->height ? here + l->stride : here;
		for (int x = 0; x < l->width; x++)
			keep[x] = here[x];
		weighted(here, above, keep, y + 1 < l->height ? below : keep, l->width);
		float *swap = above;
		above = keep;
		keep = swap;
	}
}

static int floor_cell(int v, int limit)
{
	return v <= 0 ? 0 : v >= limit ? limit / CELL * CELL : v / CELL * CELL;
}

static void layout(struct scales *p, int width, int height, int levels)
{
	long need = 0;
	p->levels = levels < 1 ? 1 : levels > SCALES_LEVELS ? SCALES_LEVELS : levels;
	for (int l = 0; l < p->levels; l++) {
		struct scale_level *a = &p->level[l];
		a->width = (width >> l) > 1 ? width >> l : 1;
		a->height = (height >> l) > 1 ? height >> l : 1;
		a->stride = (a->width + SPARE + 15) / 16 * 16;
		need += (long)a->stride * (a->height + 1);
	}
	long rows = 2L * (p->level[0].stride + SPARE);
	if (need + rows > p->room) {
		free(p->store);
		p->room = need + rows;
		p->store = mem_array((size_t)p->room, sizeof *p->store);
	}
	float *at = p->store + rows;
	for (int l = 0; l < p->levels; l++) {
		p->level[l].px = at;
		at += (long)p->level[l].stride * (p->level[l].height + 1);
	}
}

void scales_fill(struct scales *p, const uint8_t *luma, int stride, int width, int height, int x0, int y0, int x1, int y1,
                  int levels)
{
	p->x0 = floor_cell(x0, width - CELL);
	p->y0 = floor_cell(y0, height - CELL);
	int right = x1 < width ? x1 : width, bottom = y1 < height ? y1 : height;
	int w = (right - p->x0 + CELL - 1) / CELL * CELL, h = (bottom - p->y0 + CELL - 1) / CELL * CELL;
	w = p->x0 + w > width ? width - p->x0 : w;
	h = p->y0 + h > height ? height - p->y0 : h;
	layout(p, w > 1 ? w : 1, h > 1 ? h : 1, levels);
	struct scale_level *a = &p->level[0];
	for (int y = 0; y < a->height; y++)
		row_of_bytes(a->px + (long)y * a->stride, luma + (long)(p->y0 + y) * stride + p->x0, a->width);
	down(a, p->store);
	float *half = p->store;
	for (int l = 1; l < p->levels; l++) {
		const struct scale_level *b = &p->level[l - 1];
		a = &p->level[l];
		for (int y = 0; y < a->height; y++) {
			const float *top = b->px + 2L * y * b->stride, *low = 2 * y + 1 < b->height ? top + b->stride : top;
			halve(half, top, low, b->width > 1 ? a->width : 0);
			row_of_floats(a->px + (long)y * a->stride, half, a->width);
		}
		down(a, p->store);
	}
}

void scales_free(struct scales *pyramid)
{
	free(pyramid->store);
	*pyramid = (struct scales){ 0 };
}

void scales_pack(struct pack *pack, struct scales *p)
{
	const struct scale_level *a = &p->level[0];
	int head[5] = { p->x0, p->y0, p->levels, a->width, a->height };
	PACK(pack, head);
	if (pack->reading) {
		pack->bad = pack->bad || head[2] < 0 || head[2] > SCALES_LEVELS || head[3] < 0 || head[4] < 0 || (size_t)head[3] * (size_t)head[4] > pack->n;
		if (pack->bad || !head[2])
			return;
		p->x0 = head[0];
		p->y0 = head[1];
		layout(p, head[3], head[4], head[2]);
	}
	for (int l = 0; l < p->levels; l++)
		for (int y = 0; y < p->level[l].height; y++)
			pack_bytes(pack, p->level[l].px + (long)y * p->level[l].stride, (size_t)p->level[l].width * sizeof(float));
}
