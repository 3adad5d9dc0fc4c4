/* Second pass: along each row, blocks of globe with an edge in or near them search for the nearest one (blocks.c); the
 * others are far from all skin. */
#include <math.h>

#include "image/distance/impl.h"
#include "math/simd.h"

enum { LANES = DISTANCE_LANES, GROUP = DISTANCE_GROUP, EVERY_BIT = (1 << LANES) - 1 };

/* A bit for each texel of a block that is skin. */
SIMD_INLINE unsigned skin_bits(const struct distance_scene *s, const uint8_t *material, int x)
{
	unsigned bits = 0;
	int n = s->width - x;
	for (int i = 0; n < LANES && i < n; i++)
		bits |= (unsigned)(material[x + i] == DISTANCE_SKIN) << i;
	for (int i = 0; n >= LANES && i < LANES; i += 8) {
		uint64_t word;
		memcpy(&word, material + x + i, sizeof word);
		if (__BYTE_ORDER__ == __ORDER_BIG_ENDIAN__)
			word = __builtin_bswap64(word);
		bits |= (unsigned)((word / DISTANCE_SKIN & DISTANCE_EACH) * UINT64_C(0x0102040810204080) >> 56) << i;
	}
	return bits;
}

/* The sub-pixel place where the row changes from skin to other, between x and x - step. */
static float row_edge(const struct distance_scene *s, const float *cover, int x, int step)
{
	float c[4];
	for (int i = 0; i < 4; i++) {
		int at = x + (i - 2) * step;
		c[i] = at >= 0 && at < s->width ? cover[at] : 0;
	}
	return (float)x - (float)step * distance_crossing(c[0], c[1], c[2], c[3]);
}

/* Edges between the texels of a row, n blocks from block k in the direction of step: x of the last edge passed. */
SIMD_INLINE void row_edges(const struct distance_span *r, float *last, const uint16_t *skin, int k, int n, int step)
{
	const float *cover = r->f->scene->coverage + (size_t)r->y * (size_t)r->f->scene->width;
	float at = (float)-step * DISTANCE_FAR;
	unsigned was = 0;  // the last texel passed
	for (; n > 0; n--, k += step) {
		float *restrict to = last + k * LANES;
		unsigned is = skin[k], passed = step > 0 ? is << 1 | was : is >> 1 | was << (LANES - 1);
		for (int i = 0; i < LANES; i++)
			to[i] = at;
		for (unsigned edges = passed & ~is & EVERY_BIT; edges;) {
			int first = step > 0 ? __builtin_ctz(edges) : 31 - __builtin_clz(edges);
			at = row_edge(r->f->scene, cover, r->x0 + k * LANES + first, step);
			for (int i = 0; i < LANES; i++)
				to[i] = (step > 0 ? i >= first : i <= first) ? at : to[i];
			edges &= ~(1u << first);
		}
		was = step > 0 ? is >> (LANES - 1) : is & 1;
	}
}

/* Marks with 1 the blocks of globe with an edge or skin in or near them. n: whole groups. */
SIMD_INLINE void choose(uint8_t *restrict near, const uint8_t *restrict has, const uint8_t *restrict edge, int n, int wide)
{
	for (int k = 0; k < n; k += GROUP) {
		uint64_t any = 0;
		for (int w = k - wide; w <= k + wide; w++)
			any |= distance_group(edge + w) | distance_group(has + w) / DISTANCE_HAS_SKIN;
		any &= distance_group(has + k) & DISTANCE_EACH;
		memcpy(near + k, &any, sizeof any);
	}
}

/* The end of the run of equal bytes that begins at `from`, at most n. */
SIMD_INLINE int run_end(const uint8_t *of, int from, int n)
{
	uint64_t same = DISTANCE_EACH * of[from];
	int to = from + 1;
	for (; to + GROUP <= n && distance_group(of + to) == same; to += GROUP)
		;
	for (; to < n && of[to] == of[from]; to++)
		;
	return to;
}

/* Blocks [from, to), each with an edge near it. skin: from skin_bits(), with coverage only. Returns the texture reads. */
SIMD_CLONES static double near_skin(const struct distance_span *r, const uint8_t *edge, uint16_t *skin, int from, int to)
{
	const struct distance_scene *s = r->f->scene;
	const uint8_t *m = s->material + (size_t)r->y * (size_t)s->width;
	int wide = r->f->wide;
	bool fine = s->coverage;
	for (int k = from - wide; k < to + wide; k++) {
		uint8_t has = r->has[k];
		float all = has & DISTANCE_ALL_SKIN ? 0 : DISTANCE_FAR;
		if (fine)
			skin[k] = has & DISTANCE_ALL_SKIN ? EVERY_BIT : has & DISTANCE_HAS_SKIN ? (uint16_t)skin_bits(s, m, r->x0 + k * LANES) : 0;
		if (!edge[k])
			for (int i = 0; i < LANES; i++)
				r->v[k * LANES + i] = all;
	}
	if (fine) {
		row_edges(r, r->left, skin, from - wide, to - from + wide, 1);
		row_edges(r, r->right, skin, to + wide - 1, to - from + wide, -1);
	}
	return LANES * ((fine ? 3.0 : 1.0) * (to - from) + 2.0 * distance_blocks(r, from, to));
}

/* Blocks [from, to), none of them with an edge near it. */
SIMD_INLINE void off_skin(const struct distance_span *r, int from, int to)
{
	const struct distance_scene *s = r->f->scene;
	for (int k = from, end; k < to; k = end) {
		int x = r->x0 + k * LANES, right;
		end = run_end(r->has, k, to);
		right = r->x0 + end * LANES;
		size_t at = (size_t)r->y * (size_t)s->width + (size_t)x;
		if (r->has[k] & DISTANCE_HAS_GLOBE)
			distance_far(r->out + at, s->material + at, (right < s->width ? right : s->width) - x, r->has[k] & DISTANCE_ALL_GLOBE);
	}
}

SIMD_CLONES static double row(struct distance_span *r, uint8_t *has, uint8_t *near, uint16_t *skin, int n)
{
	const struct distance_field *f = r->f;
	const uint8_t *edge = f->edge + distance_at(f, f->first, r->y);
	double reads = 0;
	memset(has, 0, (size_t)f->wide);
	memcpy(has + f->wide, distance_has(f, r->y) + f->first, (size_t)n);
	memset(has + f->wide + n, 0, (size_t)f->wide);
	r->has = has + f->wide;
	choose(near, r->has, edge, n, f->wide);
	for (int from = 0, to; from < n; from = to) {
		to = run_end(near, from, n);
		if (near[from])
			reads += near_skin(r, edge, skin + f->wide, from, to);
		else
			off_skin(r, from, to);
	}
	return reads;
}

double distance_row(const struct distance_field *f, int y, double reach, float *out, float (*nearest)[2])
{
	_Alignas(64) float line[2][f->pitch * LANES];
	uint8_t has[f->pitch], near[f->pitch];
	uint16_t skin[f->pitch];
	struct distance_span r = { .f = f, .y = y, .x0 = f->first * LANES, .reach = reach, .v = f->v + distance_at(f, f->first, y) * LANES,
		                       .left = line[0] + f->wide * LANES, .right = line[1] + f->wide * LANES, .out = out, .nearest = nearest };
	return row(&r, has, near, skin, f->last - f->first);
}
