#include "image/photo/part.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "math/simd.h"

static int within(int i, int n)
{
	return i < 0 ? 0 : i >= n ? n - 1 : i;
}

/* Shares of [a, b) that pixels first .. last of n cover; those at the border have what lies beyond it, too. */
struct shares { int first, last; double a, b; int n; };

static struct shares shares_of(double a, double b, int n)
{
	return (struct shares){ within((int)floor(a), n), within((int)ceil(b) - 1, n), a, b, n };
}

static float share(const struct shares *s, int i)
{
	const double from = i == 0 ? s->a : fmax(s->a, i), to = i == s->n - 1 ? s->b : fmin(s->b, i + 1.0);
	return (float)((to - from) / (s->b - s->a));
}

/* Adds a weighted row to another. */
SIMD_CLONES static void add_row(float *restrict row, const uint16_t *restrict from, int n, float weight)
{
	SIMD_LOOP for (int k = 0; k < n; k++)
		row[k] += weight * (float)from[k];
}

/* Mean of the rows that [a, b) covers, from column `left` on, n columns. */
static void mean_row(float *restrict row, const struct photo *photo, int left, int n, double a, double b)
{
	const struct shares rows = shares_of(a, b, photo->height);
	memset(row, 0, sizeof *row * 3 * (size_t)n);
	for (int j = rows.first; j <= rows.last; j++)
		add_row(row, photo->rgb + 3 * ((long)j * photo->width + left), 3 * n, share(&rows, j) / 65535);
}

/* The columns of each of the result's pixels, counted from `left` on, and their shares: [width][most]. */
struct columns { int left, n, most, *first, *count; float *weight; };

static struct columns columns_of(const struct photo *photo, double x0, double scale, double half, int width)
{
	struct columns c = { .most = (int)ceil(2 * half) + 1, .first = mem_array((size_t)width, sizeof(int)), .count = mem_array((size_t)width, sizeof(int)) };
	c.weight = mem_array((size_t)width * (size_t)c.most, sizeof(float));
	for (int x = 0; x < width; x++) {
		const double middle = x0 + (x + 0.5) * scale;
		const struct shares s = shares_of(middle - half, middle + half, photo->width);
		if (x == 0)
			c.left = s.first;
		c.n = s.last - c.left + 1;
		c.first[x] = s.first - c.left;
		c.count[x] = s.last - s.first + 1;
		for (int i = s.first; i <= s.last; i++)
			c.weight[x * c.most + i - s.first] = share(&s, i);
	}
	return c;
}

float *photo_part(const struct photo *photo, double x0, double y0, double scale, int width, int height)
{
	const double half = 0.5 * fmax(scale, 1);
	const long plane = (long)width * height;
	struct columns columns = columns_of(photo, x0, scale, half, width);
	float *out = mem_array((size_t)(3 * plane), sizeof *out);
#pragma omp parallel
	{
		float *row = mem_array(3 * (size_t)columns.n, sizeof *row);
#pragma omp for
		for (int y = 0; y < height; y++) {
			const double middle = y0 + (y + 0.5) * scale;
			mean_row(row, photo, columns.left, columns.n, middle - half, middle + half);
			for (int x = 0; x < width; x++) {
				const float *weight = columns.weight + (long)x * columns.most, *from = row + 3 * columns.first[x];
				float sum[3] = { 0 };
				for (int i = 0; i < columns.count[x]; i++)
					for (int c = 0; c < 3; c++)
						sum[c] += weight[i] * from[3 * i + c];
				for (int c = 0; c < 3; c++)
					out[c * plane + (long)y * width + x] = sum[c];
			}
		}
		free(row);
	}
	free(columns.first);
	free(columns.count);
	free(columns.weight);
	return out;
}

/* Codes of a row of three planes, `plane` values apart. */
SIMD_CLONES static void encode_row(uint16_t *restrict to, const float *restrict from, long plane, int width)
{
	static const float WHOLE = 12582912.0f;  // 1.5 2^23: a sum with it is rounded to whole numbers
	SIMD_LOOP for (int x = 0; x < width; x++)
		for (int c = 0; c < 3; c++) {
			const float v = from[c * plane + x], most = v < 1 ? v : 1;
			to[3 * x + c] = (uint16_t)(int)(65535 * most + WHOLE - WHOLE);
		}
}

struct photo photo_reduced(const struct photo *photo, int long_px, double *scale)
{
	const int longer = photo->width > photo->height ? photo->width : photo->height;
	struct photo out = *photo;
	*scale = fmax((double)longer / long_px, 1);
	out.width = (int)fmax(round(photo->width / *scale), 1);
	out.height = (int)fmax(round(photo->height / *scale), 1);
	const long n = (long)out.width * out.height;
	float *planes = photo_part(photo, 0, 0, *scale, out.width, out.height);
	out.rgb = mem_array((size_t)(3 * n), sizeof *out.rgb);
#pragma omp parallel for
	for (int y = 0; y < out.height; y++)
		encode_row(out.rgb + 3L * y * out.width, planes + (long)y * out.width, n, out.width);
	free(planes);
	return out;
}
