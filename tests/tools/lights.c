/* lights ONE.exr OTHER.exr: by how much an eye's diffuse light (of its layers) differs in two pictures, in luminance, over the iris: a
 * circle about the picture's middle, two fifths as wide as it, which the iris of a front view fills. Per cent: the mean, of the mean; the median of the second
 * over the first, less 1; pixels away from edges (their neighbours within 5 %) that are off by more than 10. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "base/mem.h"
#include "image/exr.h"

static double luminance(const struct image *p, int x, int y)
{
	const float *v = image_at(p, x, y);
	return 0.2126 * (double)v[0] + 0.7152 * (double)v[1] + 0.0722 * (double)v[2];
}

static bool even(const struct image *p, int x, int y)
{
	double at = luminance(p, x, y);
	for (int k = 0; k < 9; k++)
		if (fabs(luminance(p, x + k % 3 - 1, y + k / 3 - 1) - at) > 0.05 * at)
			return false;
	return true;
}

static int ascending(const void *a, const void *b)
{
	double x = *(const double *)a, y = *(const double *)b;
	return (x > y) - (x < y);
}

int main(int argc, char **argv)
{
	static const char *const names[] = { "diffuse.R", "diffuse.G", "diffuse.B" };
	struct image a, b;
	struct err err = { 0 };
	if (argc != 3 || !exr_read(&a, argv[1], 3, names, 1L << 26, 0, &err) || !exr_read(&b, argv[2], 3, names, 1L << 26, 0, &err)
	    || a.width != b.width || a.height != b.height) {
		fprintf(stderr, "lights: two pictures of one size, please: %s\n", err.msg);
		return 2;
	}
	double off = 0, all = 0, *ratio = mem_array((size_t)a.width * (size_t)a.height, sizeof *ratio);
	long n = 0, smooth = 0, wrong = 0;
	for (int y = 1; y < a.height - 1; y++)
		for (int x = 1; x < a.width - 1; x++) {
			double u = luminance(&a, x, y), v = luminance(&b, x, y);
			if (hypot(x - 0.5 * a.width, y - 0.5 * a.height) > 0.2 * a.width || !(u > 1e-3))
				continue;
			bool counts = even(&a, x, y);
			off += fabs(v - u);
			all += u;
			ratio[n++] = v / u;
			smooth += counts;
			wrong += counts && fabs(v - u) > 0.1 * u;
		}
	if (!n)
		return 2;
	qsort(ratio, (size_t)n, sizeof *ratio, ascending);
	printf("%.2f %.2f %.2f\n", 100 * off / all, 100 * (ratio[n / 2] - 1), 100.0 * (double)wrong / (double)(smooth ? smooth : 1));
	free(ratio);
	image_free(&a);
	image_free(&b);
	return 0;
}
