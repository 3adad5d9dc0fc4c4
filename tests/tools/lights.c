/* lights ONE.exr OTHER.exr: by how much an eye's diffuse light (of its layers) differs in two pictures, in luminance, within a circle
 * about their middle, two fifths as wide as they are, which the iris fills in a front view. Per cent of the first's mean: the mean
 * difference of pixels; of blocks of 8 x 8; of all. Then the pixels away from edges (neighbours within 5 %) that are off by 10 %.
 */
#include <math.h>
#include <stdio.h>

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

/* Mean luminance of a block; less than nothing: not all of it lies in the circle. */
static double block(const struct image *p, int x0, int y0, int side)
{
	double sum = 0;
	for (int y = y0; y < y0 + side; y++)
		for (int x = x0; x < x0 + side; x++) {
			if (hypot(x + 0.5 - 0.5 * p->width, y + 0.5 - 0.5 * p->height) > 0.2 * p->width)
				return -1;
			sum += luminance(p, x, y);
		}
	return sum / (side * side);
}

int main(int argc, char **argv)
{
	enum { SIDE = 8 };
	static const char *const names[] = { "diffuse.R", "diffuse.G", "diffuse.B" };
	struct image a, b;
	struct err err = { 0 };
	if (argc != 3 || !exr_read(&a, argv[1], 3, names, 1L << 26, 0, &err) || !exr_read(&b, argv[2], 3, names, 1L << 26, 0, &err)
	    || a.width != b.width || a.height != b.height) {
		fprintf(stderr, "lights: two pictures of one size, please: %s\n", err.msg);
		return 2;
	}
	double off[2] = { 0 }, all[2] = { 0 }, bias = 0, smooth = 0, wrong = 0;
	for (int y = SIDE; y < a.height - SIDE; y++)
		for (int x = SIDE; x < a.width - SIDE; x++)
			for (int k = 0; k < 2; k++) {
				int side = k ? SIDE : 1;
				double u = x % side || y % side ? -1 : block(&a, x, y, side), v = u < 0 ? 0 : block(&b, x, y, side);
				if (u < 0)
					continue;
				off[k] += fabs(v - u);
				all[k] += u;
				if (k)
					continue;
				bool counts = even(&a, x, y);
				bias += v - u;
				smooth += counts;
				wrong += counts && fabs(v - u) > 0.1 * u;
			}
	printf("%.2f %.2f %.2f %.2f\n", 100 * off[0] / all[0], 100 * off[1] / all[1], 100 * bias / all[0], 100 * wrong / smooth);
	image_free(&a);
	image_free(&b);
	return all[1] > 0 && smooth > 0 ? 0 : 2;
}
