/* Upsampling: bilinear interpolation of the level below, with weights that fall with the difference in depth. */
#include <string.h>

#include "image/subsurface/lanes.h"
#include "image/subsurface/impl.h"

#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC optimize("fp-contract=fast")  // see math/simd.h
#endif

typedef subsurface_lanes lanes;
typedef subsurface_mask mask;
enum { LANES = SUBSURFACE_LANES };

/* Weight of a texel of the level below: falls with its difference in depth from this one; never 0, for the case that all
 * four are elsewhere in depth. */
SIMD_INLINE float share(float z, float there, float inv, float part)
{
	float d = z - there, f = 1 - d * d * inv;
	f = (f > 0 ? f : 0) + 1e-4f;
	return there > 0 ? part * f : 0;
}

/* A row, and the nearer (0) and farther (1) row of the level below: r, g, b, z. */
struct row {
	const float *z, *below[2][4];
	float *out[3], keep[3], *mean[3];  // mean: room for the two rows below, 3 : 1
	const unsigned char *flat;         // of each part
	int n, n_below;
	long ahead;  // from there to what will be asked for soon; 0: it is at hand
};

/* The end of the run of parts beginning at `from` that are processed alike. The two ends of a row, whose neighbours lie
 * outside, are processed alone. */
SIMD_INLINE int part_end(int from, int n)
{
	enum { PART = 2 * SUBSURFACE_PART };
	int to = from ? (from / PART + 1) * PART : 2;
	to = to < n - 2 ? to : from < n - 2 ? (n - 2) / 2 * 2 : n;
	return to > from ? to : n;
}

/* The farther neighbour of texel x in a row below; the nearer one is x / 2. */
SIMD_INLINE int farther(const struct row *r, int x)
{
	int at = x % 2 ? x / 2 + 1 : x / 2 - 1;
	return at < 0 ? 0 : at < r->n_below ? at : r->n_below - 1;
}

/* Texels [from, to), one by one: out = keep out + the interpolated level below, where there is skin. */
SIMD_INLINE void join_single(const struct row *r, int from, int to, float inv)
{
	for (int x = from; x < to; x++) {
		const float *near = r->below[0][3], *far = r->below[1][3];
		int a = x / 2, b = farther(r, x);
		float p = share(r->z[x], near[a], inv, 9), q = share(r->z[x], near[b], inv, 3);
		float s = share(r->z[x], far[a], inv, 3), t = share(r->z[x], far[b], inv, 1);
		float all = (p + q) + (s + t), each = 1 / (all > 0 ? all : 1);
		for (int c = 0; c < 3 && r->z[x] > 0; c++) {
			const float *u = r->below[0][c], *v = r->below[1][c];
			r->out[c][x] = r->keep[c] * r->out[c][x] + each * ((p * u[a] + q * u[b]) + (s * v[a] + t * v[b]));
		}
	}
}

/* The same in vectors. from is even; neither is at an end of the row. */
SIMD_INLINE void join_uneven(const struct row *r, int from, int to, float inv)
{
	static const float bilinear[4] = { 9, 3, 3, 1 };
	int x = from;
	for (; x + LANES <= to; x += LANES) {
		lanes z = *(const lanes *)(r->z + x), part[4][4], weight[4], all = { 0 };
		for (int k = 0; k < 2; k++)
			for (int c = 0; c < 4; c++) {
				lanes v = *(const lanes *)(r->below[k][c] + x / 2 - 1);
				part[2 * k][c] = __builtin_shufflevector(v, v, 1, 1, 2, 2, 3, 3, 4, 4);
				part[2 * k + 1][c] = __builtin_shufflevector(v, v, 0, 2, 1, 3, 2, 4, 3, 5);
			}
		for (int k = 0; k < 4; k++) {
			lanes there = part[k][3], f = 1 - (z - there) * (z - there) * inv;
			f = bilinear[k] * ((lanes)((mask)f & (f > 0)) + 1e-4f);
			weight[k] = (lanes)((mask)f & (there > 0));
			all += weight[k];
		}
		all = 1 / (all + 1e-30f);  // none: nothing
		for (int c = 0; c < 3; c++) {
			lanes *out = (lanes *)(r->out[c] + x);
			lanes sum = (weight[0] * part[0][c] + weight[1] * part[1][c]) + (weight[2] * part[2][c] + weight[3] * part[3][c]);
			*out = SUBSURFACE_SELECT(z > 0, r->keep[c] * *out + all * sum, *out);
		}
	}
	join_single(r, x, to, inv);
}

/* The same where all depths are about equal: plain bilinear. from and to are even, neither at an end of the row. */
SIMD_INLINE void join_even(const struct row *row, int from, int to)
{
	for (int c = 0; c < 3; c++) {
		float *restrict out = row->out[c] + from, keep = row->keep[c];
		const float *restrict mean = row->mean[c] + from / 2;
		int i = 0, n = (to - from) / 2;
		for (; i + LANES <= n; i += LANES) {
			lanes here = 0.75f * *(const lanes *)(mean + i), *to2 = (lanes *)(out + 2 * i);
			lanes left = here + 0.25f * *(const lanes *)(mean + i - 1);
			lanes right = here + 0.25f * *(const lanes *)(mean + i + 1);
			to2[0] = keep * to2[0] + __builtin_shufflevector(left, right, 0, 8, 1, 9, 2, 10, 3, 11);
			to2[1] = keep * to2[1] + __builtin_shufflevector(left, right, 4, 12, 5, 13, 6, 14, 7, 15);
		}
		for (; i < n; i++) {
			out[2 * i] = keep * out[2 * i] + (0.75f * mean[i] + 0.25f * mean[i - 1]);
			out[2 * i + 1] = keep * out[2 * i + 1] + (0.75f * mean[i] + 0.25f * mean[i + 1]);
		}
	}
}

SIMD_CLONES static void join_row(const struct row *row, float inv)
{
	for (int k = 0; k < 3; k++) {
		const float *restrict a = row->below[0][k], *restrict b = row->below[1][k];
		float *restrict mean = row->mean[k];
		SIMD_LOOP
		for (int i = 0; i < row->n_below; i++)
			mean[i] = 0.75f * a[i] + 0.25f * b[i];
	}
	const unsigned char *flat = row->flat;
	for (int from = 0, to; from < row->n; from = to) {
		to = part_end(from, row->n);
		for (int c = 0; c < 3 && row->ahead; c++)
			subsurface_ahead(row->out[c] + row->ahead + from, to - from);
		if (!from || to == row->n)
			join_single(row, from, to, inv);
		else if (*flat++)
			join_even(row, from, to);
		else
			join_uneven(row, from, to, inv);
	}
}

/* At 60 degrees a surface falls by 1.7 texels in one; the farthest of the four is 2.1 off. Shares end at 6. */
enum { SHARES_END = 6 };

SIMD_CLONES void subsurface_join_look(unsigned char *flat, const struct subsurface_level *l, const struct subsurface_level *lower, const int y[2])
{
	const float *a = lower->in[3] + (size_t)y[0] * (size_t)lower->stride, *b = lower->in[3] + (size_t)y[1] * (size_t)lower->stride;
	const unsigned char *even = lower->even + (size_t)y[0] * (size_t)lower->parts, *even1 = lower->even + (size_t)y[1] * (size_t)lower->parts;
	// The texels above each texel lie on one surface, and so do these and their neighbours, within half the distance at
	// which weights end.
	float most = (float)(SHARES_END / (2 * l->texels_per_mm));
	for (int from = 2, to; (to = part_end(from, l->width)) < l->width; from = to) {
		int k = from / 2 / SUBSURFACE_PART;
		*flat++ = even[k] && even1[k] && subsurface_smooth(a, b, from / 2 - 1, to / 2, most);
	}
}

void subsurface_join(float *const out[3], const float keep[3], const struct subsurface_level *l, const struct subsurface_level *lower,
                     int y, const float *const below[2][4], const unsigned char *flat, float *mean)
{
	float inv = (float)(l->texels_per_mm * l->texels_per_mm / (SHARES_END * SHARES_END));
	struct row row = { .z = l->in[3] + (size_t)y * (size_t)l->stride, .flat = flat, .n = l->width, .n_below = lower->width };
	row.ahead = l->own[0] || y + 2 >= l->height ? 0 : 2 * l->stride;  // of the picture itself
	memcpy(row.below, below, sizeof row.below);
	for (int c = 0; c < 3; c++) {
		row.out[c] = out[c];
		row.keep[c] = keep[c];
		row.mean[c] = mean + (size_t)c * (size_t)lower->width;
	}
	join_row(&row, inv);
}
