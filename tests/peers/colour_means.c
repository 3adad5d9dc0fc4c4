#include "tests/peers/colour_means.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"

enum { DIMENSIONS = 5, ITERATIONS = 12, MOST = 16 };

static void feature(float f[DIMENSIONS], const float *rgb, long n, long i, int width, double place)
{
	for (int c = 0; c < 3; c++)
		f[c] = rgb[c * n + i];
	f[3] = (float)(place * (double)(i % width) / width);
	f[4] = (float)(place * (double)(i / width) / width);
}

static int nearest(const float f[DIMENSIONS], float mean[][DIMENSIONS], int k)
{
	int best = 0;
	float least = INFINITY;
	for (int j = 0; j < k; j++) {
		float d = 0;
		for (int c = 0; c < DIMENSIONS; c++)
			d += (f[c] - mean[j][c]) * (f[c] - mean[j][c]);
		if (d < least) {
			least = d;
			best = j;
		}
	}
	return best;
}

static int by_value(const void *a, const void *b)
{
	const float x = *(const float *)a, y = *(const float *)b;
	return (x > y) - (x < y);
}

/* First means: the pixel's middle of each of k equal shares of the brightness. */
static void begin(float mean[][DIMENSIONS], const float *rgb, long n, int k)
{
	float *luma = mem_array((size_t)n, sizeof *luma);
	for (long i = 0; i < n; i++)
		luma[i] = (rgb[i] + rgb[n + i] + rgb[2 * n + i]) / 3;
	qsort(luma, (size_t)n, sizeof *luma, by_value);
	for (int j = 0; j < k; j++)
		for (int c = 0; c < DIMENSIONS; c++)
			mean[j][c] = c < 3 ? luma[(2 * j + 1) * n / (2 * k)] : 0.5F;
	free(luma);
}

void colour_means(uint8_t *out, const float *rgb, const uint8_t *truth, int width, int height, int k, double place, int n_classes)
{
	const long n = (long)width * height;
	float mean[MOST][DIMENSIONS], f[DIMENSIONS];
	begin(mean, rgb, n, k);
	for (int it = 0; it < ITERATIONS; it++) {
		double sum[MOST][DIMENSIONS] = { 0 };
		long count[MOST] = { 0 };
		for (long i = 0; i < n; i++) {
			feature(f, rgb, n, i, width, place);
			out[i] = (uint8_t)nearest(f, mean, k);
			count[out[i]]++;
			for (int c = 0; c < DIMENSIONS; c++)
				sum[out[i]][c] += f[c];
		}
		for (int j = 0; j < k; j++)
			for (int c = 0; c < DIMENSIONS && count[j]; c++)
				mean[j][c] = (float)(sum[j][c] / (double)count[j]);
	}
	long votes[MOST][MOST] = { 0 };
	for (long i = 0; i < n; i++)
		votes[out[i]][truth[i]]++;
	uint8_t name[MOST] = { 0 };
	for (int j = 0; j < k; j++)
		for (int c = 1; c < n_classes; c++)
			if (votes[j][c] > votes[j][name[j]])
				name[j] = (uint8_t)c;
	for (long i = 0; i < n; i++)
		out[i] = name[out[i]];
}
