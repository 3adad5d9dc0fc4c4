#include <math.h>
#include <stdlib.h>

#include "base/mem.h"
#include "tissue/pigment/pigment.h"

struct texel {
	float thickness, share, rgb[3], key;
};

static int by_thickness(const void *a, const void *b)
{
	const struct texel *s = a, *t = b;
	return (s->thickness > t->thickness) - (s->thickness < t->thickness);
}

static int by_key(const void *a, const void *b)
{
	const struct texel *s = a, *t = b;
	return (s->key > t->key) - (s->key < t->key);
}

/* Texels that were well seen, every stride-th of a row and of a column; *n of them. */
static struct texel *gather(long *n, const struct image *clean, const struct image *thickness, double extent,
                            const struct pupil *pupil, double root, const double white[3],
                            const struct pigment_classes_conf *c)
{
	int size = clean->width, stride = size / 320 + 1;
	struct texel *all = mem_array((size_t)(size / stride + 1) * (size_t)(size / stride + 1), sizeof *all);
	*n = 0;
	for (int y = stride / 2; y < size; y += stride) {
		for (int x = stride / 2; x < size; x += stride) {
			const float *p = image_at(clean, x, y);
			double share = iris_share(pupil, root, (2 * (x + 0.5) / size - 1) * extent, (2 * (y + 0.5) / size - 1) * extent);
			if (!(p[3] > 0.5f) || share < c->inner || share > c->outer)
				continue;
			struct texel t = { .thickness = image_at(thickness, x, y)[0], .share = (float)share };
			for (int k = 0; k < 3; k++)
				t.rgb[k] = (float)(p[k] / white[k]);
			t.key = 0.2126f * t.rgb[0] + 0.7152f * t.rgb[1] + 0.0722f * t.rgb[2];
			if (isfinite(t.key) && t.thickness > 0)
				all[(*n)++] = t;
		}
	}
	return all;
}

/* Mean and scatter of the middle half by luminance (interquartile): glints, shadows and spots lie in the tails. */
static struct pigment_class class_of(struct texel *t, long n, double texels_per_sample)
{
	struct pigment_class out = { .thickness = t[n / 2].thickness };  // still sorted by thickness
	qsort(t, (size_t)n, sizeof *t, by_key);
	long low = n / 4, high = n - n / 4, m = high - low;
	double square[3] = { 0 };
	for (long i = low; i < high; i++) {
		out.share += t[i].share / (double)m;
		for (int k = 0; k < 3; k++)
			out.rgb[k] += t[i].rgb[k] / (double)m;
	}
	for (long i = low; i < high; i++)
		for (int k = 0; k < 3; k++)
			square[k] += (t[i].rgb[k] - out.rgb[k]) * (t[i].rgb[k] - out.rgb[k]);
	for (int k = 0; k < 3; k++)
		out.spread[k] = sqrt(square[k] / (double)m);
	out.texels = fmax((double)n * fmin(texels_per_sample, 1), 1);
	return out;
}

bool pigment_classify(struct pigment_classes *out, const struct image *clean, const struct image *thickness,
                      double extent, const struct pupil *pupil, double root, const double white[3],
                      const struct pigment_classes_conf *c, struct err *err)
{
	*out = (struct pigment_classes) { 0 };
	long n;
	struct texel *all = gather(&n, clean, thickness, extent, pupil, root, white, c), *ring = mem_array((size_t)n + 1, sizeof *ring);
	double pitch = 2 * extent / (clean->width / (clean->width / 320 + 1));
	double independent = pitch * pitch / (c->grain * c->grain);
	for (int r = 0; r < c->rings; r++) {
		double from = c->inner + (c->outer - c->inner) * r / c->rings, to = c->inner + (c->outer - c->inner) * (r + 1) / c->rings;
		long m = 0;
		for (long i = 0; i < n; i++)
			if (all[i].share >= from && all[i].share < to)
				ring[m++] = all[i];
		qsort(ring, (size_t)m, sizeof *ring, by_thickness);
		for (int l = 0; l < c->levels && out->n < PIGMENT_CLASSES_MAX; l++) {
			long low = m * l / c->levels, high = m * (l + 1) / c->levels;
			if (high - low >= 40)
				out->of[out->n++] = class_of(ring + low, high - low, independent);
		}
	}
	free(all);
	free(ring);
	if (out->n < 3)
		return err_set(err, "iris texture: only %d classes of tissue: too little of the iris was seen", out->n);
	return true;
}
