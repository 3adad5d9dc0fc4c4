/* The separable kernel of Jimenez, Zsolnai, Jarabo, Freude, Auzinger, Wu, von der Pahlen, Wimmer and Gutierrez 2015. */
#include "tests/peers/subsurface_separable.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "image/subsurface/impl.h"
#include "math/simd.h"

#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC optimize("fp-contract=fast")  // see math/simd.h
#endif

enum { MOST = 65 };

struct kernel {
	int n, at[MOST];        // taps, px from the middle
	float weight[MOST][3];
	float inv_gap;          // of the fall-off in depth, 1/mm
};

/* Share of the profile, integrated over one direction, that lies nearer than x mm on one side. */
static double nearer(const struct subsurface_profile *p, int c, double x)
{
	double sum = 0;
	for (int i = 0; i < p->n; i++)
		sum += p->weight[i][c] * 0.5 * erf(x / sqrt(2 * p->variance[i]));
	return sum;
}

static void make(struct kernel *k, const struct subsurface_profile *p, int taps, double px_per_mm)
{
	double range = 2.5 * sqrt(p->variance[p->n - 1]), half = taps / 2;
	k->n = taps;
	k->inv_gap = (float)(1 / range);
	for (int i = 0; i < taps; i++) {
		double j = i - half, cut[2];  // the tap stands for what lies up to half way to the next ones
		k->at[i] = (int)lround(copysign(j * j / (half * half), j) * range * px_per_mm);
		for (int e = 0; e < 2; e++) {
			double m = j + e - 0.5;
			cut[e] = fabs(m) > half ? copysign(1e3, m) : copysign(m * m / (half * half), m) * range;
		}
		for (int c = 0; c < 3; c++)
			k->weight[i][c] = (float)(nearer(p, c, cut[1]) - nearer(p, c, cut[0]));
	}
}

/* One line: out += weight (middle + share (there - middle)). */
SIMD_CLONES static void tap(float *restrict out, const float *restrict middle, const float *restrict there, const float *restrict z,
                            const float *restrict z_there, int n, float weight, float inv_gap)
{
	SIMD_LOOP
	for (int i = 0; i < n; i++) {
		float f = 1 - fabsf(z[i] - z_there[i]) * inv_gap;
		f = f > 0 ? f : 0;
		out[i] += weight * (middle[i] + f * (there[i] - middle[i]));
	}
}

/* One row along x (from padded copies) or along y. */
static void row_x(float *const out[3], const struct subsurface_picture *p, const struct kernel *k, int y, float *buffer)
{
	int side = k->at[k->n - 1], wide = p->width + 2 * side;
	size_t at = (size_t)y * (size_t)p->width;
	memset(buffer, 0, 4 * (size_t)wide * sizeof *buffer);
	for (int c = 0; c < 4; c++)
		memcpy(buffer + (size_t)c * (size_t)wide + side, (c < 3 ? p->rgb[c] : p->depth) + at, (size_t)p->width * sizeof *buffer);
	const float *z = buffer + 3 * (size_t)wide + side;
	for (int c = 0; c < 3; c++) {
		const float *in = buffer + (size_t)c * (size_t)wide + side;
		memset(out[c] + at, 0, (size_t)p->width * sizeof *out[c]);
		for (int i = 0; i < k->n; i++)
			tap(out[c] + at, in, in + k->at[i], z, z + k->at[i], p->width, k->weight[i][c], k->inv_gap);
	}
}

static void row_y(const struct subsurface_picture *p, float *const in[3], const struct kernel *k, int y, float *sum)
{
	long at = (long)y * p->width;
	for (int c = 0; c < 3; c++) {
		float *out = p->rgb[c] + at;
		memset(sum, 0, (size_t)p->width * sizeof *sum);
		for (int i = 0; i < k->n; i++) {
			int row = y + k->at[i];
			long there = row < 0 || row >= p->height ? at : (long)row * p->width;
			tap(sum, in[c] + at, in[c] + there, p->depth + at, p->depth + there, p->width, k->weight[i][c], k->inv_gap);
		}
		SIMD_LOOP
		for (int i = 0; i < p->width; i++)
			out[i] = p->depth[at + i] > 0 ? sum[i] : out[i];
	}
}

void subsurface_separable(const struct subsurface_picture *p, const struct subsurface_profile *profile, int taps,
                         struct subsurface_room *room)
{
	struct kernel k;
	size_t n = (size_t)p->width * (size_t)p->height;
	float *between[3];
	subsurface_room_make(room, 3 * (n + 16));
	make(&k, profile, taps, p->px_per_mm);
	for (int c = 0; c < 3; c++)
		between[c] = subsurface_room_take(room, n);
#pragma omp parallel
	{
		float *buffer = mem_array(4 * (size_t)(p->width + 2 * k.at[k.n - 1]), sizeof *buffer);
#pragma omp for schedule(static)
		for (int y = 0; y < p->height; y++)
			row_x(between, p, &k, y, buffer);
#pragma omp for schedule(static)
		for (int y = 0; y < p->height; y++)
			row_y(p, between, &k, y, buffer);
		free(buffer);
	}
}
