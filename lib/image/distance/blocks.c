/* The nearest edge of every texel of a block: the minimum of k^2 + v^2 over the columns k away, nearest first, until no
 * column farther away can be nearer. */
#include <math.h>

#include "image/distance/impl.h"
#include "math/simd.h"

enum { LANES = DISTANCE_LANES };

/* State of a block of texels: squared distance in px and, relative to each texel, the nearest column with v there and one
 * column to either side; then the edge. */
struct block {
	float best[LANES], column[LANES], v[3][LANES], off[2][LANES];
};

/* True where any column within the band has an edge within the band. */
SIMD_INLINE bool any_near(const float *v, int band)
{
	float least[LANES], low = INFINITY;
	memcpy(least, v, sizeof least);
	for (int from = -band - 1, end = band + 1; from < end + LANES; from += LANES) {
		const float *at = v + (from < end ? from : end);
		SIMD_LOOP
		for (int i = 0; i < LANES; i++) {
			float a = fabsf(at[i]), b = fabsf(least[i]);
			least[i] = a < b ? a : b;
		}
	}
#pragma omp simd reduction(min : low)
	for (int i = 0; i < LANES; i++)
		low = least[i] < low ? least[i] : low;
	return low <= (float)band;
}

/* One texel of them. */
struct texel {
	float best, column, v[3];
};

/* Takes the columns k away on the left and on the right into the minimum. */
SIMD_INLINE struct texel look(struct texel t, const float *v, int k, bool columns)
{
	const float *left = v - k, *right = v + k;
	float side = (float)k, reach = side * side, p = right[0] * right[0] + reach, q = left[0] * left[0] + reach, d = p < q ? p : q, best = d < t.best ? d : t.best;
	int turn = p < q, nearer = best < t.best;
	if (columns) {
		float to = turn ? side : -side, a = turn ? right[-1] : left[-1], b = turn ? right[0] : left[0], c = turn ? right[1] : left[1];
		t.column = nearer ? to : t.column;
		t.v[0] = nearer ? a : t.v[0];
		t.v[1] = nearer ? b : t.v[1];
		t.v[2] = nearer ? c : t.v[2];
	}
	t.best = best;
	return t;
}

/* The minimum over columns out to the band; returns how many were visited on each side. Every ROUND columns it tests whether
 * any farther column can be nearer. */
SIMD_INLINE int search(struct block *restrict b, const float *restrict v, int band, bool columns)
{
	enum { ROUND = 4 };
	SIMD_LOOP
	for (int i = 0; i < LANES; i++) {
		b->best[i] = v[i] * v[i];
		b->column[i] = 0;
		b->v[0][i] = v[i - 1];
		b->v[1][i] = v[i];
		b->v[2][i] = v[i + 1];
	}
	for (int from = 1; from <= band; from += ROUND) {
		float worst = 0, least = (float)from * (float)from;
#pragma omp simd reduction(max : worst)
		for (int i = 0; i < LANES; i++)
			worst = b->best[i] > worst ? b->best[i] : worst;
		if (from > 1 && worst <= least)
			return from - 1;
		SIMD_LOOP
		for (int i = 0; i < LANES; i++) {
			struct texel t = { b->best[i], b->column[i], { b->v[0][i], b->v[1][i], b->v[2][i] } };
			t = look(t, v + i, from, columns);
			t = look(t, v + i, from + 1, columns);
			t = look(t, v + i, from + 2, columns);
			t = look(t, v + i, from + 3, columns);
			b->best[i] = t.best;
			b->column[i] = t.column;
			b->v[0][i] = t.v[0];
			b->v[1][i] = t.v[1];
			b->v[2][i] = t.v[2];
		}
	}
	return band;
}

/* On a mask the nearest edge is that column's. */
SIMD_INLINE void take_columns(struct block *b)
{
	memcpy(b->off[0], b->column, sizeof b->off[0]);
	memcpy(b->off[1], b->v[1], sizeof b->off[1]);
}

/* The nearest point of the segment to the edge in the next column, where both belong to one edge. */
SIMD_INLINE void along(float *restrict best, float *restrict offx, float *restrict offy, float ax, float ay, float by, float ex)
{
	const float break_px = 4;  // in one column: steeper is another edge
	float ey = by - ay, jump = ey < 0 ? -ey : ey, t = -(ax * ex + ay * ey) / (1 + ey * ey);
	t = t < 0 ? 0 : t;
	t = t > 1 ? 1 : t;
	float px = ax + t * ex, py = ay + t * ey, d = px * px + py * py;
	int nearer = (by * ay > 0) & (jump <= break_px) & (d < *best);
	*offx = nearer ? px : *offx;
	*offy = nearer ? py : *offy;
	*best = nearer ? d : *best;
}

/* Sub-pixel refinement with coverage: the edge runs as a segment between the edges of two neighbouring columns, or crosses
 * the row itself. Without coverage texels are points. */
SIMD_INLINE void refine(struct block *restrict b, const float *restrict left, const float *restrict right, float x0)
{
	SIMD_LOOP
	for (int i = 0; i < LANES; i++) {
		float ax = b->column[i], ay = b->v[1][i], best = b->best[i], offx = ax, offy = ay, x = x0 + (float)i;
		along(&best, &offx, &offy, ax, ay, b->v[0][i], -1);
		along(&best, &offx, &offy, ax, ay, b->v[2][i], 1);
		float l = x - left[i], r = right[i] - x, h = l < r ? l : r, d = h * h, to = l < r ? -l : r;
		int across = d <= best;
		b->off[0][i] = across ? to : offx;
		b->off[1][i] = across ? 0 : offy;
		b->best[i] = across ? d : best;
	}
}

/* Distances across the screen into a whole block. */
SIMD_INLINE void give_flat(float *restrict out, const uint8_t *restrict material, const float *restrict d2, float reach)
{
	int of[LANES];  // in the width of the others: one vector
	SIMD_LOOP
	for (int i = 0; i < LANES; i++)
		of[i] = material[i];
	SIMD_LOOP
	for (int i = 0; i < LANES; i++) {
		float d = sqrtf(d2[i]), to = d <= reach ? d : INFINITY;
		out[i] = of[i] == DISTANCE_GLOBE ? to : out[i];
	}
}

SIMD_INLINE void give_flat_whole(float *restrict out, const float *restrict d2, float reach)
{
	SIMD_LOOP
	for (int i = 0; i < LANES; i++) {
		float d = sqrtf(d2[i]);
		out[i] = d <= reach ? d : INFINITY;
	}
}

/* Writes the results of one block, texel by texel. */
static void give(const struct distance_span *r, const struct block *b, int x)
{
	const struct distance_scene *s = r->f->scene;
	float most = (float)r->f->band * (float)r->f->band;
	for (int i = 0; i < LANES && x + i < s->width; i++) {
		size_t at = (size_t)r->y * (size_t)s->width + (size_t)(x + i);
		if (s->material[at] != DISTANCE_GLOBE)
			continue;
		float off[2] = { b->off[0][i], b->off[1][i] }, d = b->best[i] <= most ? distance_in_world(s, x + i, r->y, off, b->best[i]) : INFINITY;
		bool found = (double)d <= r->reach;
		r->out[at] = found ? d : INFINITY;
		if (r->nearest && found)
			memcpy(r->nearest[at], off, sizeof off);
	}
}

SIMD_CLONES void distance_far(float *restrict out, const uint8_t *restrict material, int n, bool all)
{
	SIMD_LOOP
	for (int i = 0; i < n; i++)
		out[i] = all || material[i] == DISTANCE_GLOBE ? INFINITY : out[i];
}

SIMD_INLINE int one_block(const struct distance_span *r, int k, bool fine, bool flat)
{
	const struct distance_scene *s = r->f->scene;
	struct block b;
	int x = r->x0 + k * LANES, at = k * LANES, n = s->width - x;
	size_t to = (size_t)r->y * (size_t)s->width + (size_t)x;
	bool all = r->has[k] & DISTANCE_ALL_GLOBE;
	if (fine && !any_near(r->v + at, r->f->band)) {
		distance_far(r->out + to, s->material + to, n < LANES ? n : LANES, all);
		return 0;
	}
	int looked = search(&b, r->v + at, r->f->band, fine || !flat);
	if (fine)
		refine(&b, r->left + at, r->right + at, (float)x);
	else if (!flat)
		take_columns(&b);
	if (!flat || n < LANES)
		give(r, &b, x);
	else if (all)
		give_flat_whole(r->out + to, b.best, (float)r->reach);
	else
		give_flat(r->out + to, s->material + to, b.best, (float)r->reach);
	return looked;
}

SIMD_CLONES static int blocks_flat(const struct distance_span *r, int from, int to)
{
	int looked = 0;
	for (int k = from; k < to; k++)
		looked += one_block(r, k, false, true);
	return looked;
}

SIMD_CLONES static int blocks_mask(const struct distance_span *r, int from, int to)
{
	int looked = 0;
	for (int k = from; k < to; k++)
		looked += one_block(r, k, false, false);
	return looked;
}

SIMD_CLONES static int blocks_fine(const struct distance_span *r, int from, int to)
{
	bool flat = !r->f->scene->depth && !r->nearest;
	int looked = 0;
	for (int k = from; k < to; k++)
		looked += one_block(r, k, true, flat);
	return looked;
}

int distance_blocks(const struct distance_span *r, int from, int to)
{
	const struct distance_scene *s = r->f->scene;
	bool flat = !s->depth && !r->nearest && s->width % LANES == 0;
	return s->coverage ? blocks_fine(r, from, to) : flat ? blocks_flat(r, from, to) : blocks_mask(r, from, to);
}
