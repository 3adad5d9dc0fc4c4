/* The distance field's second pass: along each row the smallest of k^2 + v^2 over the columns k away, nearest first, until
 * no column farther away can be nearer. */
#include <math.h>
#include <string.h>

#include "base/mem.h"
#include "image/distance_impl.h"
#include "math/simd.h"

enum { LANES = DISTANCE_LANES, GROUP = DISTANCE_GROUP };

/* A row of the window, with room for what the band reaches into. */
struct row {
	const struct distance_field *f;
	int y, first, x0;        // first block of the arrays; px of its first texel
	int wide;                // blocks that the band reaches into
	double reach;            // world units
	float *v;                // distance to the nearest edge in the column
	float *left, *right;     // x of the last edge in the row on either side, as far as it is in the run; coverage only
	uint8_t *has, *edge;     // of each block
	float *out, (*nearest)[2];  // the screen's
};

/* A block of texels on its way: squared distance in px, and what is nearest, relative to each: its column, then the edge. */
struct block {
	float best[LANES], column[LANES], off[2][LANES];
};

/* The column pass of one block into the row. */
SIMD_INLINE void fill(const struct row *r, int k)
{
	const struct distance_field *f = r->f;
	float *v = r->v + k * LANES;
	bool skin = r->has[k] & DISTANCE_ALL_SKIN;
	if (!skin && r->edge[k]) {
		int block = r->first + k;
		memcpy(v, f->v + (distance_at(f, block / GROUP, r->y) * GROUP + (size_t)(block % GROUP)) * LANES, LANES * sizeof *v);
		return;
	}
	for (int i = 0; i < LANES; i++)
		v[i] = skin ? 0 : DISTANCE_FAR;
}

static float cover_at(const struct distance_scene *s, const float *cover, int x)
{
	return x >= 0 && x < s->width ? cover[x] : 0;
}

/* Edges between the texels of a row, from block k on, n blocks in the direction of step: x of the last one passed. */
static void row_edges(const struct row *r, float *last, int k, int n, int step)
{
	const struct distance_scene *s = r->f->scene;
	const uint8_t *m = s->material + (size_t)r->y * (size_t)s->width;
	const float *cover = s->coverage + (size_t)r->y * (size_t)s->width;
	float at = (float)-step * DISTANCE_FAR;
	bool was = false;
	for (; n > 0; n--, k += step) {
		float *to = last + k * LANES;
		bool skin = r->has[k] & DISTANCE_HAS_SKIN;
		int x = r->x0 + k * LANES + (step > 0 ? 0 : LANES - 1);
		for (int i = 0; i < LANES && (skin || was) && !(r->has[k] & DISTANCE_ALL_SKIN); i++, x += step) {
			bool is = skin && x < s->width && m[x] == DISTANCE_SKIN;
			if (was && !is)
				at = (float)x - (float)step * distance_crossing(cover_at(s, cover, x - 2 * step), cover_at(s, cover, x - step), cover_at(s, cover, x), cover_at(s, cover, x + step));
			was = is;
			last[x - r->x0] = at;
			skin |= was;
		}
		for (int i = 0; i < LANES && !skin; i++)
			to[i] = at;
		was = r->has[k] & DISTANCE_ALL_SKIN || (skin && was);
	}
}

/* The smallest over columns out to the band; returns how many were looked at on each side. Whether any farther column can
 * be nearer is asked every ROUND columns. */
SIMD_INLINE int search(struct block *restrict out, const float *restrict v, int band, bool columns)
{
	enum { ROUND = 4 };
	float best[LANES], column[LANES], most = (float)band * (float)band;
	for (int i = 0; i < LANES; i++) {
		best[i] = v[i] * v[i];
		column[i] = 0;
	}
	for (int from = 1; from <= band; from += ROUND) {
		float worst = 0, least = (float)from * (float)from;
#pragma omp simd reduction(max : worst)
		for (int i = 0; i < LANES; i++)
			worst = best[i] > worst ? best[i] : worst;
		if (worst <= least || most < least) {
			band = from - 1;
			break;
		}
		for (int k = from; k < from + ROUND; k++) {
			float side = (float)k, reach = side * side;
			SIMD_LOOP
			for (int i = 0; i < LANES; i++) {
				float p = v[i + k] * v[i + k] + reach, q = v[i - k] * v[i - k] + reach, d = p < q ? p : q;
				if (columns) {
					float to = p < q ? side : -side;
					column[i] = d < best[i] ? to : column[i];
				}
				best[i] = d < best[i] ? d : best[i];
			}
		}
	}
	memcpy(out->best, best, sizeof best);
	memcpy(out->column, column, sizeof column);
	return band;
}

/* On a mask the nearest edge is that column's. */
SIMD_INLINE void take_columns(struct block *b, const float *v)
{
	for (int i = 0; i < LANES; i++) {
		b->off[0][i] = b->column[i];
		b->off[1][i] = v[i + (int)b->column[i]];
	}
}

/* Between the edges found in two neighbouring columns runs the edge itself: the nearest point of that segment, where both
 * belong to one edge; or the edge that the row itself crosses. Only with coverage: a mask's texels are points. */
SIMD_INLINE void refine(struct block *restrict b, const float *restrict v, const float *restrict left, const float *restrict right,
                               float x0)
{
	SIMD_LOOP
	for (int i = 0; i < LANES; i++) {
		const float break_px = 4;  // in one column: steeper is another edge
		int c = i + (int)b->column[i];
		float ax = b->column[i], ay = v[c], best = b->best[i], offx = ax, offy = ay, x = x0 + (float)i;
		for (int side = -1; side <= 1; side += 2) {
			float by = v[c + side], ex = (float)side, ey = by - ay, jump = ey < 0 ? -ey : ey;
			float t = -(ax * ex + ay * ey) / (1 + ey * ey);
			t = t < 0 ? 0 : t > 1 ? 1 : t;
			float px = ax + t * ex, py = ay + t * ey, d = px * px + py * py;
			int nearer = (by * ay > 0) & (jump <= break_px) & (d < best);
			offx = nearer ? px : offx;
			offy = nearer ? py : offy;
			best = nearer ? d : best;
		}
		float l = x - left[i], r = right[i] - x, h = l < r ? l : r, d = h * h;
		int across = d <= best;
		b->off[0][i] = across ? (l < r ? -l : r) : offx;
		b->off[1][i] = across ? 0 : offy;
		b->best[i] = across ? d : best;
	}
}

/* Distances across the screen into a whole block. */
SIMD_INLINE void give_flat(float *restrict out, const uint8_t *restrict material, const float *restrict d2, float reach)
{
	SIMD_LOOP
	for (int i = 0; i < LANES; i++) {
		float d = sqrtf(d2[i]), to = d <= reach ? d : INFINITY;
		out[i] = material[i] == DISTANCE_GLOBE ? to : out[i];
	}
}

/* Globe's texels of n that are far from all skin; all of them, where the blocks hold nothing else. */
SIMD_CLONES static void give_far(float *restrict out, const uint8_t *restrict material, int n, bool all)
{
	SIMD_LOOP
	for (int i = 0; i < n; i++)
		out[i] = all || material[i] == DISTANCE_GLOBE ? INFINITY : out[i];
}

/* What was found, into the texels of one block, one by one. */
static void give(const struct row *r, const struct block *b, int x)
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

SIMD_INLINE int one_block(const struct row *r, int k, bool fine)
{
	const struct distance_scene *s = r->f->scene;
	struct block b;
	int x = r->x0 + k * LANES, at = k * LANES;
	const float *v = r->v + at;
	size_t to = (size_t)r->y * (size_t)s->width + (size_t)x;
	bool flat = !s->depth && !r->nearest && x + LANES <= s->width;
	int looked = search(&b, v, r->f->band, fine || !flat);
	if (fine)
		refine(&b, v, r->left + at, r->right + at, (float)x);
	else if (!flat)
		take_columns(&b, v);
	if (flat)
		give_flat(r->out + to, s->material + to, b.best, (float)r->reach);
	else
		give(r, &b, x);
	return looked;
}

SIMD_CLONES static int blocks_mask(const struct row *r, int from, int to)
{
	int looked = 0;
	for (int k = from; k < to; k++)
		looked += one_block(r, k, false);
	return looked;
}

SIMD_CLONES static int blocks_fine(const struct row *r, int from, int to)
{
	int looked = 0;
	for (int k = from; k < to; k++)
		looked += one_block(r, k, true);
	return looked;
}

/* Blocks of globe with an edge in or near them: 1. */
SIMD_CLONES static void choose(uint8_t *restrict near, const uint8_t *restrict has, const uint8_t *restrict edge, int n, int wide)
{
	memset(near, 0, (size_t)n);
	for (int w = -wide; w <= wide; w++)
		for (int k = 0; k < n; k++)
			near[k] |= edge[k + w];
	for (int k = 0; k < n; k++)
		near[k] &= has[k];
}

/* What the row's blocks hold, and whether skin or an edge is among it; n of them, with nothing `wide` beyond either end. */
static void open_row(const struct row *r, int n)
{
	const struct distance_field *f = r->f;
	memset(r->has, 0, (size_t)n);
	memset(r->edge, 0, (size_t)n);
	for (int group = f->first, k = r->wide; group < f->last; group++, k += GROUP) {
		uint64_t has = distance_has(f, group, r->y), edge = f->edge[distance_at(f, group, r->y)];
		edge |= has / DISTANCE_HAS_SKIN & DISTANCE_EACH;
		for (int i = 0; i < GROUP; i++)
			r->has[k + i] = (uint8_t)(has >> 8 * i);
		for (int i = 0; i < GROUP; i++)
			r->edge[k + i] = (uint8_t)(edge >> 8 * i);
	}
}

/* Blocks [from, to), each with an edge near it. */
static double near_skin(const struct row *r, int from, int to)
{
	for (int k = from - r->wide; k < to + r->wide; k++)
		fill(r, k);
	if (!r->f->scene->coverage)
		return LANES * (to - from + 2.0 * blocks_mask(r, from, to));
	row_edges(r, r->left, from - r->wide, to - from + r->wide, 1);
	row_edges(r, r->right, to + r->wide - 1, to - from + r->wide, -1);
	return LANES * (3.0 * (to - from) + 2.0 * blocks_fine(r, from, to));
}

/* Blocks [from, to), none of them with an edge near it. */
static void off_skin(const struct row *r, int from, int to)
{
	const struct distance_scene *s = r->f->scene;
	for (int k = from, end; k < to; k = end) {
		int x = r->x0 + k * LANES, right;
		for (end = k + 1; end < to && r->has[end] == r->has[k]; end++)
			;
		right = r->x0 + end * LANES;
		size_t at = (size_t)r->y * (size_t)s->width + (size_t)x;
		if (r->has[k] & DISTANCE_HAS_GLOBE)
			give_far(r->out + at, s->material + at, (right < s->width ? right : s->width) - x, r->has[k] & DISTANCE_ALL_GLOBE);
	}
}

double distance_row(const struct distance_field *f, int y, double reach, float *out, float (*nearest)[2])
{
	int wide = (f->band + 3 + LANES) / LANES, n = (f->last - f->first) * GROUP + 2 * wide;
	float line[3][n * LANES];
	uint8_t has[n], edge[n], near[n];
	struct row r = { .f = f, .y = y, .first = f->first * GROUP - wide, .wide = wide, .reach = reach, .v = line[0], .left = line[1],
		             .right = line[2], .has = has, .edge = edge, .out = out, .nearest = nearest };
	double reads = 0;
	r.x0 = r.first * LANES;
	open_row(&r, n);
	choose(near, has + wide, edge + wide, n - 2 * wide, wide);
	for (int from = 0, to; from < n - 2 * wide; from = to) {
		for (to = from + 1; to < n - 2 * wide && near[to] == near[from]; to++)
			;
		if (near[from])
			reads += near_skin(&r, from + wide, to + wide);
		else
			off_skin(&r, from + wide, to + wide);
	}
	return reads;
}
