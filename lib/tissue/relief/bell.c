#include "tissue/relief/bell.h"

#include <math.h>
#include <stdlib.h>

#include "base/mem.h"

enum { STRIP = 32 };  // columns at a time

/* A box: 2 half + 1 texels, and `edge` of one more on either side. */
struct box {
	int half;
	float edge, inv;
};

/* Of that variance: sum of k^2 over the box, by its length. */
static struct box box_of(double variance)
{
	int half = (int)((sqrt(1 + 12 * variance) - 1) / 2);
	double whole = half * (half + 1.0) * (2 * half + 1) / 3, next = (half + 1.0) * (half + 1.0), length = 2 * half + 1;
	double edge = (variance * length - whole) / (2 * (next - variance));
	return (struct box){ half, (float)edge, (float)(1 / (length + 2 * edge)) };
}

/* The box down `wide` columns of in[n][n] side by side, into as many rows of the transposed out. Sums in double: running sums of float drift. */
static void down(float *restrict out, const float *restrict in, int n, int wide, const struct box *b, float (*restrict strip)[STRIP])
{
	double sum[STRIP] = { 0 };
	for (int k = 0; k < b->half && k < n; k++)
		for (int i = 0; i < wide; i++)
			sum[i] += (double)in[(long)k * n + i];
	for (int k = 0; k < n; k++) {
		static const float nothing[STRIP] = { 0 };
		const float *next = k + b->half < n ? in + (long)(k + b->half) * n : nothing, *beyond = k + b->half + 1 < n ? next + n : nothing;
		const float *last = k - b->half - 1 >= 0 ? in + (long)(k - b->half - 1) * n : nothing;
		for (int i = 0; i < wide; i++) {
			sum[i] += (double)next[i] - (double)last[i];
			strip[k][i] = b->inv * ((float)sum[i] + b->edge * (beyond[i] + last[i]));
		}
	}
	for (int i = 0; i < wide; i++)
		for (int k = 0; k < n; k++)
			out[(long)i * n + k] = strip[k][i];
}

void bell_blur(float *map, int n, double sigma, int twice, float *scratch)
{
	const struct box b = box_of(sigma * sigma / 4);
	float (*strip)[STRIP] = mem_array((size_t)n, sizeof *strip);
	for (int k = 0; k < 4 * twice; k++) {  // twice along either axis: each time the map is transposed
		float *in = k % 2 ? scratch : map, *out = k % 2 ? map : scratch;
		for (int x = 0; x < n; x += STRIP)
			down(out + (long)x * n, in + x, n, n - x < STRIP ? n - x : STRIP, &b, strip);
	}
	free(strip);
}
