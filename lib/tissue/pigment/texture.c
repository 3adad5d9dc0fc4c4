#include "tissue/pigment/texture.h"

#include <math.h>

#include "base/mem.h"

/* A map's channels at a point, bilinear. */
static void map_at(float out[4], const struct image *map, double extent, double x, double y)
{
	int n = map->width;
	double u = fmin(fmax((x / extent + 1) / 2 * n - 0.5, 0), n - 1.001), v = fmin(fmax((y / extent + 1) / 2 * n - 0.5, 0), n - 1.001);
	int i = (int)u, j = (int)v;
	for (int c = 0; c < 4; c++) {
		double top = image_at(map, i, j)[c] + (u - i) * (image_at(map, i + 1, j)[c] - image_at(map, i, j)[c]);
		double low = image_at(map, i, j + 1)[c] + (u - i) * (image_at(map, i + 1, j + 1)[c] - image_at(map, i, j + 1)[c]);
		out[c] = (float)(top + (v - j) * (low - top));
	}
}

/* Mean colour of a square of texels; false where not all were well seen. */
static bool mean_of(float rgb[3], const struct image *clean, int x0, int y0, int side)
{
	rgb[0] = rgb[1] = rgb[2] = 0;
	for (int i = 0; i < side * side; i++) {
		const float *p = image_at(clean, x0 + i % side, y0 + i / side);
		if (!(p[3] > 0.5f))
			return false;
		for (int c = 0; c < 3; c++)
			rgb[c] += p[c] / (float)(side * side);
	}
	return true;
}

struct pigment_texel *pigment_texels(long *n, double *pitch, const struct pigment_texture *in, double inner, double outer)
{
	int size = in->clean->width, side = size / 320 + 1;
	struct pigment_texel *all = mem_array((size_t)(size / side + 1) * (size_t)(size / side + 1), sizeof *all);
	*n = 0;
	*pitch = 2 * in->extent / (size / side);
	for (int y = 0; y + side <= size; y += side) {
		for (int x = 0; x + side <= size; x += side) {
			double u = (2 * (x + 0.5 * side) / size - 1) * in->extent, v = (2 * (y + 0.5 * side) / size - 1) * in->extent;
			double share = iris_share(in->pupil, in->root, u, v);
			float rgb[3], here[4];
			if (share < inner || share > outer || !mean_of(rgb, in->clean, x, y, side))
				continue;
			map_at(here, in->light, in->extent, u, v);
			struct pigment_texel t = { .thickness = image_at(in->thickness, x + side / 2, y + side / 2)[0], .share = (float)share,
				                       .x = (float)u, .y = (float)v };
			for (int k = 0; k < 3; k++)
				t.rgb[k] = (float)(rgb[k] / (in->white[k] * here[k]));
			t.key = 0.2126f * t.rgb[0] + 0.7152f * t.rgb[1] + 0.0722f * t.rgb[2];
			if (isfinite(t.key) && t.thickness > 0)
				all[(*n)++] = t;
		}
	}
	return all;
}
