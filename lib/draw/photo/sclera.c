#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "draw/photo/photo.h"

struct white {
	float key, rgb[3];
};

static int before(const void *a, const void *b)
{
	float x = ((const struct white *)a)->key, y = ((const struct white *)b)->key;
	return (x > y) - (x < y);
}

static float lum(const float *p)
{
	return 0.2126f * p[0] + 0.7152f * p[1] + 0.0722f * p[2];
}

bool sclera_is_white(const float p[3], const float own[3])
{
	return lum(p) > 0.08f && lum(own) < 0.95f && p[0] < 1.42f * p[1] && p[1] < 1.5f * p[2] && p[2] < 1.15f * p[1];
}

/* Candidates beside the limbus, by how little red stands above blue; returns how many. */
static long candidates(struct white *list, const struct shot *shot, const double white[3], long *ring)
{
	const struct image *m = &shot->image;
	long n = 0;
	*ring = 0;
	for (int y = 0; y < m->height; y++)
		for (int x = 0; x < m->width; x++) {
			double r = ellipse_radius(&shot->fit.limbus, shot->window[0] + (x + 0.5) * shot->scale,
			                          shot->window[1] + (y + 0.5) * shot->scale);
			const float *own = image_at(m, x, y), p[3] = { own[0] / (float)white[0], own[1] / (float)white[1], own[2] / (float)white[2] };
			if (r < 1.15 || r > 1.6)
				continue;
			++*ring;
			if (sclera_is_white(p, own))
				list[n++] = (struct white){ p[0] / p[2], { p[0], p[1], p[2] } };
		}
	return n;
}

bool sclera_of_photo(double rgb[3], const struct shot *shot, const double white[3])
{
	long ring, n;
	struct white *list = mem_array((size_t)shot->image.width * (size_t)shot->image.height, sizeof *list);
	n = candidates(list, shot, white, &ring);
	bool enough = n > 200 && n > ring / 20;
	if (enough) {
		// Neither the reddest, skin and vessels, nor the bluest, the soft limbus; of the others the brighter half without the brightest
		// tenth: neither the lids' shadow nor wet highlights.
		qsort(list, (size_t)n, sizeof *list, before);
		memmove(list, list + n / 10, (size_t)(n / 2) * sizeof *list);
		n /= 2;
		for (long i = 0; i < n; i++)
			list[i].key = lum(list[i].rgb);
		qsort(list, (size_t)n, sizeof *list, before);
		long lo = n * 45 / 100, hi = n * 90 / 100;
		for (int c = 0; c < 3; c++) {
			rgb[c] = 0;
			for (long i = lo; i < hi; i++)
				rgb[c] += list[i].rgb[c] / (double)(hi - lo);
		}
	}
	free(list);
	return enough;
}
