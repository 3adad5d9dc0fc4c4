#include <math.h>
#include <stdlib.h>

#include "base/mem.h"
#include "render/render.h"

struct white {
	float lum, rgb[3];
};

static int darker(const void *a, const void *b)
{
	float x = ((const struct white *)a)->lum, y = ((const struct white *)b)->lum;
	return (x > y) - (x < y);
}

/* Neither skin nor vessel nor reflection, by colour alone. */
static bool is_white(const float p[3], float lum)
{
	return lum > 0.08f && lum < 0.95f && p[0] < 1.42f * p[1] && p[1] < 1.5f * p[2] && p[2] < 1.15f * p[1];
}

bool sclera_of_photo(double rgb[3], const struct shot *shot)
{
	const struct image *m = &shot->image;
	struct white *list = mem_array((size_t)m->width * (size_t)m->height, sizeof *list);
	long n = 0, ring = 0;
	for (int y = 0; y < m->height; y++)
		for (int x = 0; x < m->width; x++) {
			double r = ellipse_radius(&shot->fit.limbus, shot->window[0] + (x + 0.5) * shot->scale,
			                          shot->window[1] + (y + 0.5) * shot->scale);
			const float *p = image_at(m, x, y);
			float lum = 0.2126f * p[0] + 0.7152f * p[1] + 0.0722f * p[2];
			if (r < 1.15 || r > 1.6)
				continue;
			ring++;
			if (is_white(p, lum))
				list[n++] = (struct white){ lum, { p[0], p[1], p[2] } };
		}
	bool enough = n > 200 && n > ring / 20;
	if (enough) {
		// The brighter half without the brightest: neither the lids' shadow nor a wet highlight.
		qsort(list, (size_t)n, sizeof *list, darker);
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
