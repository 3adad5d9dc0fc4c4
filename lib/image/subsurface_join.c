/* From a level of the pyramid to the one above: bilinear, over the four texels as far as their depth is the pixel's. */
#include <math.h>
#include <string.h>

#include "image/subsurface_level.h"
#include "math/simd.h"

#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC optimize("fp-contract=fast")  // see math/simd.h
#endif

/* A texel of the level below: its share as far as its depth is this one's; a trace of it whatever its depth, where all
 * four lie elsewhere. */
SIMD_INLINE float share(float z, float there, float inv, float part)
{
	float d = z - there, f = 1 - d * d * inv;
	f = (f > 0 ? f : 0) + 1e-4f;
	return there > 0 ? part * f : 0;
}

/* A row, and of the level below the nearer row (0) and the farther one (1): r, g, b, z. */
struct row {
	const float *z, *below[2][4];
	float *out[3], keep[3], *mean[3];  // mean: room for the two rows below, 3 : 1
	const unsigned char *even;  // of the nearer row below
	int n, n_below;
	long ahead;  // from there to what will be asked for soon; 0: it is at hand
};

enum { PART = 2 * SUBSURFACE_PART };  // texels that take one way or the other

/* The farther neighbour of texel x in a row below; the nearer one is x / 2. */
SIMD_INLINE int farther(const struct row *r, int x)
{
	int at = x % 2 ? x / 2 + 1 : x / 2 - 1;
	return at < 0 ? 0 : at < r->n_below ? at : r->n_below - 1;
}

/* Texels [from, to): out = keep out + what comes from below, where there is skin. */
SIMD_INLINE void join_uneven(const struct row *row, int from, int to, float inv)
{
	float part[4][4][PART], weight[4][PART];
	const float *restrict z = row->z + from;
	int n = to - from;
	for (int i = 0; i < n; i++) {
		int a = (from + i) / 2, b = farther(row, from + i);
		for (int k = 0; k < 4; k++) {
			part[k][0][i] = row->below[0][k][a];
			part[k][1][i] = row->below[0][k][b];
			part[k][2][i] = row->below[1][k][a];
			part[k][3][i] = row->below[1][k][b];
		}
	}
	SIMD_LOOP
	for (int i = 0; i < n; i++) {
		float p = share(z[i], part[3][0][i], inv, 9), q = share(z[i], part[3][1][i], inv, 3);
		float s = share(z[i], part[3][2][i], inv, 3), t = share(z[i], part[3][3][i], inv, 1);
		float all = (p + q) + (s + t), each = 1 / (all > 0 ? all : 1);
		weight[0][i] = p * each;
		weight[1][i] = q * each;
		weight[2][i] = s * each;
		weight[3][i] = t * each;
	}
	for (int c = 0; c < 3; c++) {
		float *restrict out = row->out[c] + from, keep = row->keep[c];
		SIMD_LOOP
		for (int i = 0; i < n; i++) {
			float now = keep * out[i] + ((weight[0][i] * part[c][0][i] + weight[1][i] * part[c][1][i])
			                             + (weight[2][i] * part[c][2][i] + weight[3][i] * part[c][3][i]));
			out[i] = z[i] > 0 ? now : out[i];
		}
	}
}

/* The same where all depths are as good as one: bilinear. from and to are even, neither at an end of the row. */
SIMD_INLINE void join_even(const struct row *row, int from, int to)
{
	for (int c = 0; c < 3; c++) {
		float *restrict out = row->out[c] + from, keep = row->keep[c];
		const float *restrict mean = row->mean[c] + from / 2;
		int i = 0, n = (to - from) / 2;
		for (; i + SUBSURFACE_LANES <= n; i += SUBSURFACE_LANES) {
			subsurface_lanes here = 0.75f * *(const subsurface_lanes *)(mean + i), *to2 = (subsurface_lanes *)(out + 2 * i);
			subsurface_lanes left = here + 0.25f * *(const subsurface_lanes *)(mean + i - 1);
			subsurface_lanes right = here + 0.25f * *(const subsurface_lanes *)(mean + i + 1);
			to2[0] = keep * to2[0] + __builtin_shufflevector(left, right, 0, 8, 1, 9, 2, 10, 3, 11);
			to2[1] = keep * to2[1] + __builtin_shufflevector(left, right, 4, 12, 5, 13, 6, 14, 7, 15);
		}
		for (; i < n; i++) {
			out[2 * i] = keep * out[2 * i] + (0.75f * mean[i] + 0.25f * mean[i - 1]);
			out[2 * i + 1] = keep * out[2 * i + 1] + (0.75f * mean[i] + 0.25f * mean[i + 1]);
		}
	}
}

/* Whether all that is looked at lies on one surface, at up to 60 degrees to the camera, about half of where shares end: what
 * lies above each texel of the level below does; so do these and their neighbours, if they differ by no more than `most`. */
SIMD_INLINE bool even(const struct row *row, int from, int to, float most)
{
	const float *restrict a = row->below[0][3] + from / 2, *restrict b = row->below[1][3] + from / 2;
	float across = 0, along = 0;
	for (int k = from / 2 / SUBSURFACE_PART; k <= (to / 2 - 1) / SUBSURFACE_PART; k++)
		if (!row->even[k])
			return false;
#pragma omp simd reduction(max : across, along)
	for (int i = -1; i < (to - from) / 2; i++) {
		float d = fabsf(a[i] - b[i]), e = fabsf(a[i] - a[i + 1]);
		across = d > across ? d : across;
		along = e > along ? e : along;
	}
	return across + along <= most;
}

SIMD_CLONES static void join_row(const struct row *row, float inv)
{
	float most = sqrtf(0.25f / inv);
	for (int k = 0; k < 3; k++) {
		const float *restrict a = row->below[0][k], *restrict b = row->below[1][k];
		float *restrict mean = row->mean[k];
		SIMD_LOOP
		for (int i = 0; i < row->n_below; i++)
			mean[i] = 0.75f * a[i] + 0.25f * b[i];
	}
	for (int from = 0, to; from < row->n; from = to) {
		to = from ? (from / PART + 1) * PART : 2;  // the ends, whose neighbours lie outside, alone
		to = to < row->n - 2 ? to : from < row->n - 2 ? (row->n - 2) / 2 * 2 : row->n;
		to = to > from ? to : row->n;
		for (int c = 0; c < 3 && row->ahead; c++)
			subsurface_ahead(row->out[c] + row->ahead + from, to - from);
		if (from > 0 && to < row->n && even(row, from, to, most))
			join_even(row, from, to);
		else
			join_uneven(row, from, to, inv);
	}
}

void subsurface_join(float *const out[3], const float keep[3], const struct subsurface_level *l, const struct subsurface_level *lower,
                     int y, const float *const below[2][4], float *mean)
{
	// At 60 degrees a surface falls by 1.7 texels in one; the farthest of the four is 2.1 off.
	float inv = (float)(l->texels_per_mm * l->texels_per_mm / 36);
	struct row row = { .z = l->in[3] + (size_t)y * (size_t)l->stride, .n = l->width, .n_below = lower->width };
	row.ahead = l->own[0] || y + 2 >= l->height ? 0 : 2 * l->stride;  // of the picture itself
	row.even = lower->even + (size_t)(y / 2) * (size_t)lower->parts;
	memcpy(row.below, below, sizeof row.below);
	for (int c = 0; c < 3; c++) {
		row.out[c] = out[c];
		row.keep[c] = keep[c];
		row.mean[c] = mean + (size_t)c * (size_t)lower->width;
	}
	join_row(&row, inv);
}
