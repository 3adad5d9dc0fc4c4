#include <math.h>
#include <stdlib.h>

#include "base/mem.h"
#include "math/stats.h"
#include "tissue/pigment/pigment.h"

struct texel {
	float thickness, share, rgb[3], key;
};

static int by_key(const void *a, const void *b)
{
	const struct texel *s = a, *t = b;
	return (s->key > t->key) - (s->key < t->key);
}

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

/* Squares of texels that were well seen, divided by what white would show there; *n of them. */
static struct texel *gather(long *n, const struct image *clean, const struct image *thickness, double extent,
                            const struct pupil *pupil, double root, const double white[3], const struct image *light,
                            const struct pigment_classes_conf *c)
{
	int size = clean->width, side = size / 320 + 1;
	struct texel *all = mem_array((size_t)(size / side + 1) * (size_t)(size / side + 1), sizeof *all);
	*n = 0;
	for (int y = 0; y + side <= size; y += side) {
		for (int x = 0; x + side <= size; x += side) {
			double u = (2 * (x + 0.5 * side) / size - 1) * extent, v = (2 * (y + 0.5 * side) / size - 1) * extent;
			double share = iris_share(pupil, root, u, v);
			float rgb[3], here[4];
			if (share < c->inner || share > c->outer || !mean_of(rgb, clean, x, y, side))
				continue;
			map_at(here, light, extent, u, v);
			struct texel t = { .thickness = image_at(thickness, x + side / 2, y + side / 2)[0], .share = (float)share };
			for (int k = 0; k < 3; k++)
				t.rgb[k] = (float)(rgb[k] / (white[k] * here[k]));
			t.key = 0.2126f * t.rgb[0] + 0.7152f * t.rgb[1] + 0.0722f * t.rgb[2];
			if (isfinite(t.key) && t.thickness > 0)
				all[(*n)++] = t;
		}
	}
	return all;
}

/* Mean and scatter of n texels. */
static struct pigment_class class_of(const struct texel *t, long n, double texels_per_sample)
{
	struct pigment_class out = { 0 };
	double square[3] = { 0 };
	for (long i = 0; i < n; i++) {
		out.share += t[i].share / (double)n;
		for (int k = 0; k < 3; k++)
			out.rgb[k] += t[i].rgb[k] / (double)n;
	}
	for (long i = 0; i < n; i++)
		for (int k = 0; k < 3; k++)
			square[k] += (t[i].rgb[k] - out.rgb[k]) * (t[i].rgb[k] - out.rgb[k]);
	for (int k = 0; k < 3; k++)
		out.spread[k] = sqrt(square[k] / (double)n);
	out.texels = fmax((double)n * fmin(texels_per_sample, 1), 1);
	return out;
}

/* Standard score below which a share p of a normal distribution lies. */
static double score(double p)
{
	double low = -6, high = 6;
	for (int i = 0; i < 50; i++) {
		double at = (low + high) / 2;
		*(erfc(-at / M_SQRT2) / 2 < p ? &low : &high) = at;
	}
	return (low + high) / 2;
}

/* Its mean between the shares p and q. */
static double score_between(double p, double q)
{
	double a = score(p), b = score(q);
	return (exp(-a * a / 2) - exp(-b * b / 2)) / sqrt(2 * M_PI) / (q - p);
}

static double median_thickness(const struct texel *t, long n)
{
	double *all = mem_array((size_t)n, sizeof *all);
	for (long i = 0; i < n; i++)
		all[i] = t[i].thickness;
	double at = stats_median((int)n, all);
	free(all);
	return at;
}

/* The levels of a ring, whose darkest and lightest texels are left out: glints, shadows and spots. */
static void classify_ring(struct pigment_classes *out, struct texel *ring, long m, int r, double independent, const struct pigment_classes_conf *c)
{
	const double tail = 0.02;
	double thickness = median_thickness(ring, m);
	qsort(ring, (size_t)m, sizeof *ring, by_key);
	for (int l = 0; l < c->levels && out->n < PIGMENT_CLASSES_MAX; l++) {
		double p = tail + (1 - 2 * tail) * l / c->levels, q = tail + (1 - 2 * tail) * (l + 1) / c->levels;
		long low = (long)((double)m * p), high = (long)((double)m * q);
		struct pigment_class *class = &out->of[out->n++];
		*class = class_of(ring + low, high - low, independent);
		class->thickness = thickness;
		class->ring = r;
		class->z = score_between(p, q);
	}
}

bool pigment_classify(struct pigment_classes *out, const struct image *clean, const struct image *thickness,
                      double extent, const struct pupil *pupil, double root, const double white[3], const struct image *light,
                      const struct pigment_classes_conf *c, struct err *err)
{
	*out = (struct pigment_classes) { 0 };
	long n;
	struct texel *all = gather(&n, clean, thickness, extent, pupil, root, white, light, c), *ring = mem_array((size_t)n + 1, sizeof *ring);
	double pitch = 2 * extent / (clean->width / (clean->width / 320 + 1));
	double independent = pitch * pitch / (c->grain * c->grain);
	for (int r = 0; r < c->rings; r++) {
		double from = c->inner + (c->outer - c->inner) * r / c->rings, to = c->inner + (c->outer - c->inner) * (r + 1) / c->rings;
		long m = 0;
		for (long i = 0; i < n; i++)
			if (all[i].share >= from && all[i].share < to)
				ring[m++] = all[i];
		if (m >= 40L * c->levels)
			classify_ring(out, ring, m, out->rings++, independent, c);
	}
	free(all);
	free(ring);
	if (out->n < 3)
		return err_set(err, "iris texture: only %d classes of tissue: too little of the iris was seen", out->n);
	return true;
}
