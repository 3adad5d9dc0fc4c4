#include "image/plane.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"

static int clamp_int(int x, int lo, int hi)
{
	return x < lo ? lo : x > hi ? hi : x;
}

enum { ABREAST = 4 };  // rows whose sums run side by side: each waits for the one before

/* Running mean over 2 radius + 1 pixels of rows of `width`, ABREAST of them or less. */
static void box_rows(float *restrict out, const float *restrict in, int rows, int width, int radius)
{
	const float *from[ABREAST], scale = 1.0f / (float)(2 * radius + 1);
	double sum[ABREAST] = { 0 };
	for (int k = 0; k < ABREAST; k++)
		from[k] = in + (long)(k < rows ? k : rows - 1) * width;
	for (int k = 0; k < ABREAST; k++)
		for (int i = -radius; i <= radius; i++)
			sum[k] += from[k][clamp_int(i, 0, width - 1)];
	for (int i = 0; i < width; i++) {
		const int add = clamp_int(i + radius + 1, 0, width - 1), sub = clamp_int(i - radius, 0, width - 1);
		for (int k = 0; k < rows; k++)
			out[(long)k * width + i] = (float)sum[k] * scale;
		for (int k = 0; k < ABREAST; k++)
			sum[k] += from[k][add] - from[k][sub];
	}
}

/* The same down the columns [x0, x1), a whole strip of them at a time. */
static void box_columns(float *out, const float *in, int width, int height, int x0, int x1, int radius)
{
	double sum[64] = { 0 };
	int n = x1 - x0;
	float scale = 1.0f / (float)(2 * radius + 1);
	for (int i = -radius; i <= radius; i++)
		for (int k = 0; k < n; k++)
			sum[k] += in[(long)clamp_int(i, 0, height - 1) * width + x0 + k];
	for (int y = 0; y < height; y++) {
		const float *add = in + (long)clamp_int(y + radius + 1, 0, height - 1) * width + x0;
		const float *sub = in + (long)clamp_int(y - radius, 0, height - 1) * width + x0;
		for (int k = 0; k < n; k++) {
			out[(long)y * width + x0 + k] = (float)sum[k] * scale;
			sum[k] += add[k] - sub[k];
		}
	}
}

/* Radius of box i of three whose variances add up to sigma² (Kovesi's choice of two neighbouring odd widths). */
static int box_radius(double sigma, int i)
{
	int low = (int)floor(sqrt(4 * sigma * sigma + 1));
	low -= low % 2 == 0;
	double n_low = (12 * sigma * sigma - 3.0 * low * low - 12.0 * low - 9) / (-4.0 * low - 4);
	return (i < (int)lrint(n_low) ? low : low + 2) / 2;
}

void plane_blur(float *px, int width, int height, double sigma)
{
	float *other = mem_array((size_t)width * (size_t)height, sizeof *other);
	for (int i = 0; i < 3; i++) {
		int radius = box_radius(sigma, i);
		if (radius < 1)
			continue;
#pragma omp parallel for schedule(static)
		for (int y = 0; y < height; y += ABREAST)
			box_rows(other + (long)y * width, px + (long)y * width, y + ABREAST < height ? ABREAST : height - y, width, radius);
#pragma omp parallel for schedule(static)
		for (int x = 0; x < width; x += 64)
			box_columns(px, other, width, height, x, x + 64 < width ? x + 64 : width, radius);
	}
	free(other);
}

void plane_blur_weighted(float *px, const float *weight, int width, int height, double sigma, float fallback)
{
	long n = (long)width * height;
	float *w = mem_array((size_t)n, sizeof *w);
	memcpy(w, weight, (size_t)n * sizeof *w);
	for (long i = 0; i < n; i++)
		px[i] = w[i] > 0 ? px[i] * w[i] : 0;
	plane_blur(px, width, height, sigma);
	plane_blur(w, width, height, sigma);
	for (long i = 0; i < n; i++)
		px[i] = w[i] > 1e-4f ? px[i] / w[i] : fallback;
	free(w);
}

float plane_sample(const float *px, int width, int height, double x, double y)
{
	double fx = floor(x - 0.5), fy = floor(y - 0.5);
	float tx = (float)(x - 0.5 - fx), ty = (float)(y - 0.5 - fy);
	int x0 = clamp_int((int)fx, 0, width - 1), x1 = clamp_int((int)fx + 1, 0, width - 1);
	const float *a = px + (long)clamp_int((int)fy, 0, height - 1) * width;
	const float *b = px + (long)clamp_int((int)fy + 1, 0, height - 1) * width;
	return (1 - ty) * ((1 - tx) * a[x0] + tx * a[x1]) + ty * ((1 - tx) * b[x0] + tx * b[x1]);
}
