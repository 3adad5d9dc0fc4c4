#include <math.h>
#include <stdlib.h>

#include "base/mem.h"
#include "math/stats.h"
#include "tissue/pigment/texture.h"

static int by_key(const void *a, const void *b)
{
	const struct pigment_texel *s = a, *t = b;
	return (s->key > t->key) - (s->key < t->key);
}

/* Mean and scatter of n texels. */
static struct pigment_class class_of(const struct pigment_texel *t, long n, double texels_per_sample)
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

/* A normal distribution's mean between the shares p and q. */
static double score_between(double p, double q)
{
	double a = stats_normal_score(p), b = stats_normal_score(q);
	return (exp(-a * a / 2) - exp(-b * b / 2)) / sqrt(2 * M_PI) / (q - p);
}

static double median_thickness(const struct pigment_texel *t, long n)
{
	double *all = mem_array((size_t)n, sizeof *all);
	for (long i = 0; i < n; i++)
		all[i] = t[i].thickness;
	double at = stats_median((int)n, all);
	free(all);
	return at;
}

/* The levels of a ring, whose darkest and lightest texels are left out: glints, shadows and spots. */
static void classify_ring(struct pigment_classes *out, struct pigment_texel *ring, long m, int r, double independent, const struct pigment_classes_conf *c)
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

bool pigment_classify(struct pigment_classes *out, const struct pigment_texture *texture, const struct pigment_classes_conf *c, struct err *err)
{
	*out = (struct pigment_classes) { 0 };
	long n;
	double pitch;
	struct pigment_texel *all = pigment_texels(&n, &pitch, texture, c->inner, c->outer), *ring = mem_array((size_t)n + 1, sizeof *ring);
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
