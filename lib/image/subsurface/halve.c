/* Downsampling: each texel of a level is the mean of the frontmost of four texels of the level above. */

#include "image/subsurface/lanes.h"
#include "image/subsurface/impl.h"

#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC optimize("fp-contract=fast")  // see math/simd.h
#endif

/* Weights of four texels: equal for those about as near as the nearest, 0 for the others. */
struct quad {
	float a, b, c, d;
};

SIMD_INLINE float depth_or_far(float z)
{
	return z > 0 ? z : 1e30f;
}

SIMD_INLINE float least(float a, float b)
{
	return a < b ? a : b;
}

SIMD_INLINE struct quad shares(float *depth, float a, float b, float c, float d, float gap)
{
	float fa = depth_or_far(a), fb = depth_or_far(b), fc = depth_or_far(c), fd = depth_or_far(d);
	float front = least(least(fa, fb), least(fc, fd)) + gap;
	struct quad q = { fa < front ? 1 : 0, fb < front ? 1 : 0, fc < front ? 1 : 0, fd < front ? 1 : 0 };
	float n = (q.a + q.b) + (q.c + q.d), each = 1 / (n > 0 ? n : 1);
	q = (struct quad){ q.a * each, q.b * each, q.c * each, q.d * each };
	*depth = (q.a * a + q.b * b) + (q.c * c + q.d * d);
	return q;
}

/* Rows 2y and 2y + 1 of the level above, of twice n texels. */
struct pair {
	const float *z[2], *rgb[2][3];
	float *z_out, *rgb_out[3];
	unsigned char *even;
	long ahead;  // from there to the next pair; 0: none, or it is at hand
};

SIMD_INLINE void halve_uneven(const struct pair *p, int from, int to, float gap)
{
	const float *a = p->z[0], *b = p->z[1], *r0 = p->rgb[0][0], *r1 = p->rgb[1][0];
	const float *g0 = p->rgb[0][1], *g1 = p->rgb[1][1], *b0 = p->rgb[0][2], *b1 = p->rgb[1][2];
	float *z = p->z_out, *r = p->rgb_out[0], *g = p->rgb_out[1], *blue = p->rgb_out[2];
	SIMD_LOOP
	for (int i = from; i < to; i++) {
		struct quad q = shares(&z[i], a[2 * i], a[2 * i + 1], b[2 * i], b[2 * i + 1], gap);
		r[i] = (q.a * r0[2 * i] + q.b * r0[2 * i + 1]) + (q.c * r1[2 * i] + q.d * r1[2 * i + 1]);
		g[i] = (q.a * g0[2 * i] + q.b * g0[2 * i + 1]) + (q.c * g1[2 * i] + q.d * g1[2 * i + 1]);
		blue[i] = (q.a * b0[2 * i] + q.b * b0[2 * i + 1]) + (q.c * b1[2 * i] + q.d * b1[2 * i + 1]);
	}
}

/* The plain mean, where each four lie within the gap. */
SIMD_INLINE void halve_even(const struct pair *p, int from, int to)
{
	for (int k = 0; k < 4; k++) {
		const float *restrict a = k < 3 ? p->rgb[0][k] : p->z[0], *restrict b = k < 3 ? p->rgb[1][k] : p->z[1];
		float *restrict out = k < 3 ? p->rgb_out[k] : p->z_out;
		int i = from;
		for (; i + SUBSURFACE_LANES <= to; i += SUBSURFACE_LANES) {
			const subsurface_lanes *above = (const subsurface_lanes *)(a + 2 * i), *below = (const subsurface_lanes *)(b + 2 * i);
			subsurface_lanes u = above[0] + below[0], v = above[1] + below[1];
			subsurface_lanes left = __builtin_shufflevector(u, v, 0, 2, 4, 6, 8, 10, 12, 14);
			subsurface_lanes right = __builtin_shufflevector(u, v, 1, 3, 5, 7, 9, 11, 13, 15);
			*(subsurface_lanes *)(out + i) = 0.25f * (left + right);
		}
		for (; i < to; i++)
			out[i] = 0.25f * ((a[2 * i] + b[2 * i]) + (a[2 * i + 1] + b[2 * i + 1]));
	}
}

SIMD_CLONES static void halve_row(const struct pair *p, int n, float gap)
{
	for (int from = 0, to; from < n; from = to) {
		to = from + SUBSURFACE_PART < n ? from + SUBSURFACE_PART : n;
		bool one = subsurface_smooth(p->z[0], p->z[1], 2 * from, 2 * to - 1, gap);
		p->even[from / SUBSURFACE_PART] = one;
		for (int k = 0; k < 8 && p->ahead; k++)
			subsurface_ahead((k < 6 ? p->rgb[k / 3][k % 3] : p->z[k - 6]) + p->ahead + 2 * from, 2 * (to - from));
		if (one)
			halve_even(p, from, to);
		else
			halve_uneven(p, from, to, gap);
	}
}

/* The last column of an odd width, which has no neighbour. */
static void halve_last(const struct pair *p, int i, float gap)
{
	struct quad q = shares(&p->z_out[i], p->z[0][2 * i], 0, p->z[1][2 * i], 0, gap);
	for (int c = 0; c < 3; c++)
		p->rgb_out[c][i] = q.a * p->rgb[0][c][2 * i] + q.c * p->rgb[1][c][2 * i];
}

/* Row y of a level, out of the one above. */
static void halve(const struct subsurface_level *l, const struct subsurface_level *above, int y)
{
	struct pair p;
	size_t to = (size_t)y * (size_t)l->stride;
	for (int k = 0; k < 2; k++) {
		int row = 2 * y + k < above->height ? 2 * y + k : 2 * y;  // counted twice, the last of an odd height
		size_t from = (size_t)row * (size_t)above->stride;
		p.z[k] = above->in[3] + from;
		for (int c = 0; c < 3; c++)
			p.rgb[k][c] = above->in[c] + from;
	}
	p.z_out = l->own[3] + to;
	p.even = l->even + (size_t)y * (size_t)l->parts;
	for (int c = 0; c < 3; c++)
		p.rgb_out[c] = l->own[c] + to;
	p.even[l->parts - 1] = 0;
	p.ahead = above->own[0] || 2 * y + 3 >= above->height ? 0 : 2 * above->stride;
	float gap = (float)(4 / above->texels_per_mm);  // a surface seen at 60 degrees falls by 2.4 texels across their diagonal
	halve_row(&p, above->width / 2, gap);
	if (above->width % 2)
		halve_last(&p, l->width - 1, gap);
	subsurface_level_sides(l, y);
}

/* All levels in one pass: the rows above a row of the deepest level are halved down to it while they are in the cache. */
void subsurface_level_halve(const struct subsurface_level *level, int deepest)
{
#pragma omp parallel for schedule(static)
	for (int k = 0; k < level[deepest].height; k++)
		for (int l = 1; l <= deepest; l++) {
			int each = 1 << (deepest - l), to = (k + 1) * each < level[l].height ? (k + 1) * each : level[l].height;
			for (int y = k * each; y < to; y++)
				halve(&level[l], &level[l - 1], y);
		}
}
