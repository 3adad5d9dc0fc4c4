#include "image/mask.h"

#include <stdbool.h>
#include <stdlib.h>

#include "base/mem.h"

enum { STRAIGHT = 3, DIAGONAL = 4, FAR = 1 << 20 };  // chamfer lengths, in thirds of a pixel

static void relax(int *d, int other, int length)
{
	if (other + length < *d)
		*d = other + length;
}

/* Distance to the nearest pixel whose mask is `value`, in thirds of a pixel. */
static int *chamfer(const uint8_t *mask, int width, int height, bool value)
{
	int *d = mem_array((size_t)width * (size_t)height, sizeof *d);
	for (int y = 0; y < height; y++)
		for (int x = 0; x < width; x++) {
			int *p = d + (long)y * width + x;
			*p = (mask[(long)y * width + x] != 0) == value ? 0 : FAR;
			if (x > 0)
				relax(p, p[-1], STRAIGHT);
			if (y > 0)
				relax(p, p[-width], STRAIGHT);
			if (y > 0 && x > 0)
				relax(p, p[-width - 1], DIAGONAL);
			if (y > 0 && x + 1 < width)
				relax(p, p[-width + 1], DIAGONAL);
		}
	for (int y = height - 1; y >= 0; y--)
		for (int x = width - 1; x >= 0; x--) {
			int *p = d + (long)y * width + x;
			if (x + 1 < width)
				relax(p, p[1], STRAIGHT);
			if (y + 1 < height)
				relax(p, p[width], STRAIGHT);
			if (y + 1 < height && x + 1 < width)
				relax(p, p[width + 1], DIAGONAL);
			if (y + 1 < height && x > 0)
				relax(p, p[width - 1], DIAGONAL);
		}
	return d;
}

void mask_grow(uint8_t *mask, int width, int height, double radius)
{
	if (radius == 0)
		return;
	bool grow = radius > 0;
	int *d = chamfer(mask, width, height, grow);
	double reach = STRAIGHT * (grow ? radius : -radius);
	for (long i = 0; i < (long)width * height; i++)
		if (d[i] <= reach)
			mask[i] = grow;
	free(d);
}

static int root_of(int *parent, int i)
{
	while (parent[i] != i)
		i = parent[i] = parent[parent[i]];
	return i;
}

static void join(int *parent, int a, int b)
{
	a = root_of(parent, a);
	b = root_of(parent, b);
	parent[a > b ? a : b] = a > b ? b : a;
}

int mask_label(int *label, const uint8_t *mask, int width, int height)
{
	// A new label starts at most at every second pixel of every second row.
	int *parent = mem_array(((size_t)width / 2 + 1) * ((size_t)height + 1) + 1, sizeof *parent);
	int n = 0;
	for (int y = 0; y < height; y++)
		for (int x = 0; x < width; x++) {
			int *p = label + (long)y * width + x;
			*p = 0;
			if (!mask[(long)y * width + x])
				continue;
			int near[4] = { x > 0 ? p[-1] : 0, y > 0 && x > 0 ? p[-width - 1] : 0, y > 0 ? p[-width] : 0,
				        y > 0 && x + 1 < width ? p[-width + 1] : 0 };
			for (int k = 0; k < 4; k++)
				if (near[k] && *p)
					join(parent, *p, near[k]);
				else if (near[k])
					*p = near[k];
			if (!*p) {
				*p = ++n;
				parent[n] = n;
			}
		}
	int *name = mem_new((size_t)n + 1, sizeof *name), count = 0;
	for (int i = 1; i <= n; i++)
		name[i] = root_of(parent, i) == i ? ++count : name[root_of(parent, i)];
	for (long i = 0; i < (long)width * height; i++)
		label[i] = name[label[i]];
	free(name);
	free(parent);
	return count;
}

void mask_keep(uint8_t *mask, const uint8_t *seed, int width, int height)
{
	const long n = (long)width * height;
	int *label = mem_array((size_t)n, sizeof *label);
	uint8_t *kept = mem_new((size_t)mask_label(label, mask, width, height) + 1, 1);
	for (long i = 0; i < n; i++)
		kept[label[i]] |= seed[i] != 0;
	for (long i = 0; i < n; i++)
		mask[i] = label[i] && kept[label[i]] ? mask[i] : 0;
	free(kept);
	free(label);
}
