/* A pyramid: every level is half as large as the one below it, blurred by the binomial of four; then the sum of its levels, from the
 * smallest to the largest, enlarged by the same (quadratic B-splines). */
#include "draw/bloom.h"

#include <math.h>

enum { LEVELS = 16, FINEST = 256, COARSEST = 8 };

static int held(int i, int n)
{
	return i < 0 ? 0 : i < n ? i : n - 1;
}

/* Half as large: 1 3 3 1 over eight, in both directions. */
static struct image halved(const struct image *in)
{
	const int n = in->channels;
	struct image row = image_new((in->width + 1) / 2, in->height, n), out = image_new(row.width, (in->height + 1) / 2, n);
#pragma omp parallel
	{
#pragma omp for schedule(static)
		for (int y = 0; y < row.height; y++)
			for (int x = 0; x < row.width; x++) {
				const float *a = image_at(in, held(2 * x - 1, in->width), y), *b = image_at(in, held(2 * x, in->width), y), *c = image_at(in, held(2 * x + 1, in->width), y),
				            *d = image_at(in, held(2 * x + 2, in->width), y);
				for (int k = 0; k < n; k++)
					image_at(&row, x, y)[k] = (a[k] + 3 * b[k] + 3 * c[k] + d[k]) / 8;
			}
#pragma omp for schedule(static)
		for (int y = 0; y < out.height; y++) {
			const float *a = image_at(&row, 0, held(2 * y - 1, in->height)), *b = image_at(&row, 0, held(2 * y, in->height)), *c = image_at(&row, 0, held(2 * y + 1, in->height)),
			            *d = image_at(&row, 0, held(2 * y + 2, in->height));
			for (int i = 0; i < out.width * n; i++)
				image_at(&out, 0, y)[i] = (a[i] + 3 * b[i] + 3 * c[i] + d[i]) / 8;
		}
	}
	image_free(&row);
	return out;
}

/* out = own * out + of * what is half as large, enlarged: 3 1 over four to either side, in both directions. */
static void add_enlarged(struct image *out, float own, float of, const struct image *half)
{
	const int n = out->channels;
#pragma omp parallel for schedule(static)
	for (int y = 0; y < out->height; y++) {
		const int v = y / 2, w = held(v + (y & 1 ? 1 : -1), half->height);
		for (int x = 0; x < out->width; x++) {
			const int s = x / 2, t = held(s + (x & 1 ? 1 : -1), half->width);
			const float *a = image_at(half, s, v), *b = image_at(half, t, v), *c = image_at(half, s, w), *d = image_at(half, t, w);
			float *p = image_at(out, x, y);
			for (int k = 0; k < n; k++)
				p[k] = own * p[k] + of * (9 * a[k] + 3 * b[k] + 3 * c[k] + d[k]) / 16;
		}
	}
}

void bloom(struct image *rgb, double share)
{
	const int side = rgb->width < rgb->height ? rgb->width : rgb->height;
	struct image level[LEVELS + 1] = { *rgb };
	int last = 0, first = 0;
	if (!(share > 0))
		return;
	for (; last < LEVELS && side >> (last + 1) >= COARSEST; last++) {
		level[last + 1] = halved(&level[last]);
		first = first ? first : side >> (last + 1) <= FINEST ? last + 1 : 0;
	}
	if (!last)
		return;  // too small for anything to glow in it
	for (int k = last - 1; k > 0; k--)
		add_enlarged(&level[k], k >= first ? 1 : 0, 1, &level[k + 1]);
	add_enlarged(rgb, (float)(1 - share), (float)(share / (last - first + 1)), &level[1]);
	for (int k = 1; k <= last; k++)
		image_free(&level[k]);
}
