#include "iris/freckle/freckle.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "iris/freckle/flat.h"
#include "iris/freckle/ground.h"
#include "image/mask.h"
#include "image/plane.h"

/* Weighted means of step x step texels. */
static void reduce(struct search *s, const struct image *rgbw, double limbus_margin)
{
	const float floor_value = 3e-4f;
#pragma omp parallel for schedule(static)
	for (int row = 0; row < s->size; row++)
		for (int col = 0; col < s->size; col++) {
			float sum[3] = { 0 }, w = 0, whole = 0;
			for (int k = 0; k < s->step * s->step; k++) {
				const float *p = image_at(rgbw, col * s->step + k % s->step, row * s->step + k / s->step);
				for (int c = 0; c < 3; c++)
					sum[c] += p[3] * p[c];
				w += p[3];
				whole += p[3] > 0.02f;
			}
			long i = (long)row * s->size + col;
			double x = (col + 0.5) * s->mm - s->sheet.extent, y = (row + 0.5) * s->mm - s->sheet.extent;
			double t = sheet_t(&s->sheet, x, y), edge = s->sheet.limbus - limbus_margin;
			s->use[i] = whole == (float)(s->step * s->step) && t > 0 && hypot(x, y) < edge;
			for (int c = 0; c < 3; c++)
				s->log[c][i] = w > 0 ? fmaxf(sum[c] / w, floor_value) : floor_value;
		}
}

static void take_logs(struct search *s, double sigma)
{
	long n = (long)s->size * s->size;
	float *weight = mem_array((size_t)n, sizeof *weight);
	for (long i = 0; i < n; i++)
		weight[i] = s->use[i];
	for (int c = 0; c < 3; c++) {
		plane_blur_weighted(s->log[c], weight, s->size, s->size, sigma, 1);
		for (long i = 0; i < n; i++)
			s->log[c][i] = logf(s->log[c][i]);
	}
	for (long i = 0; i < n; i++)
		s->ratio[i] = s->log[0][i] - s->log[1][i];
	free(weight);
}

static int by_value(const void *a, const void *b)
{
	float x = *(const float *)a, y = *(const float *)b;
	return (x > y) - (x < y);
}

static float median_ratio(const struct search *s)
{
	long n = 0, all = (long)s->size * s->size;
	float *v = mem_array((size_t)all / 16 + 1, sizeof *v);
	for (long i = 0; i < all; i += 16)
		if (s->use[i])
			v[n++] = s->ratio[i];
	qsort(v, (size_t)n, sizeof *v, by_value);
	float median = n ? v[n / 2] : 0;
	free(v);
	return median;
}

static void compare(struct search *s)
{
	struct ground *ground[3] = { ground_new(s->log[0], s->use, &s->sheet, -8.2f, 0.5f),
		                     ground_new(s->log[1], s->use, &s->sheet, -8.2f, 0.5f),
		                     ground_new(s->ratio, s->use, &s->sheet, -2, 3) };
	const float least_spread = 0.05f;  // colour noise of a good photograph
#pragma omp parallel for schedule(static)
	for (int row = 0; row < s->size; row++)
		for (int col = 0; col < s->size; col++) {
			long i = (long)row * s->size + col;
			if (!s->use[i])
				continue;
			double x = (col + 0.5) * s->mm - s->sheet.extent, y = (row + 0.5) * s->mm - s->sheet.extent;
			double t = sheet_t(&s->sheet, x, y), phi = atan2(y - s->sheet.pupil.cy, x - s->sheet.pupil.cx);
			float median, spread;
			for (int c = 0; c < 2; c++) {
				ground_at(&median, &spread, ground[c], t, phi);
				s->fall[c][i] = s->log[c][i] - median;
			}
			ground_at(&median, &spread, ground[2], t, phi);
			s->ratio[i] -= median;
			s->ratio_z[i] = s->ratio[i] / fmaxf(spread, least_spread);
		}
	for (int c = 0; c < 3; c++)
		free(ground[c]);
}

struct blob {
	long area, first;
	double x, y, fall[2], weight;
	float peak;
	bool seeded;
};

/* Opacity of a texel of a spot with that peak: 1 well inside, 0.5 at its edge, 0 outside. */
static float opacity_of(float ratio, float peak, double edge)
{
	float v = 0.5f + 0.5f * (ratio / peak - (float)edge) / (0.5f * (float)edge);
	return fminf(fmaxf(v, 0), 1);
}

static bool is_seed(const struct search *s, long i, const struct freckle_conf *conf)
{
	return s->ratio[i] > (float)conf->ratio && s->ratio_z[i] > (float)conf->ratio_z
	       && s->fall[1][i] < -(float)conf->darker && s->fall[0][i] > (float)conf->red_share * s->fall[1][i];
}

static bool may_grow(const struct search *s, long i, const struct freckle_conf *conf)
{
	return s->use[i] && s->ratio[i] > (float)(0.5 * conf->ratio) && s->fall[1][i] < -0.4f * (float)conf->darker;
}

/* Confidence of a spot: from the smallest of the tests' margins over their thresholds. */
static double confidence_of(const struct blob *b, double mm, const struct freckle_conf *conf)
{
	double red = b->fall[0] / b->fall[1], area = (double)b->area * mm * mm;
	double ratio = b->peak / conf->ratio - 1, share = (conf->red_share - red) / conf->red_share;
	double size = area / conf->min_area - 1;
	double margin = fmin(fmin(ratio, 3 * share), fmin(size, 3));
	return margin <= 0 ? 0 : 1 - 0.5 * exp(-2 * margin);
}

static void measure(struct blob *blobs, const int *label, const struct search *s, const struct freckle_conf *conf)
{
	long n = (long)s->size * s->size;
	for (long i = 0; i < n; i++) {
		struct blob *b = &blobs[label[i]];
		if (label[i] && s->ratio[i] > b->peak)
			b->peak = s->ratio[i];
	}
	for (long i = 0; i < n; i++) {
		struct blob *b = &blobs[label[i]];
		if (!label[i] || s->ratio[i] < (float)conf->edge * b->peak)
			continue;
		double o = opacity_of(s->ratio[i], b->peak, conf->edge);
		b->area++;
		b->seeded |= is_seed(s, i, conf);
		b->weight += o;
		b->x += o * ((double)(i % s->size) + 0.5);
		b->y += o * ((double)(i / s->size) + 0.5);
		b->fall[0] += o * s->fall[0][i];
		b->fall[1] += o * s->fall[1][i];
	}
}

static int larger_first(const void *a, const void *b)
{
	double x = ((const struct freckle *)a)->area, y = ((const struct freckle *)b)->area;
	return (x < y) - (x > y);
}

/* Spots redder than the iris around them. opacity: [s->size][s->size], zeroed. */
static void find_coloured(struct freckles *out, float *opacity, const struct search *s,
                          const struct freckle_conf *conf)
{
	long n = (long)s->size * s->size;
	uint8_t *mask = mem_array((size_t)n, 1);
	int *label = mem_array((size_t)n, sizeof *label);
	for (long i = 0; i < n; i++)
		mask[i] = may_grow(s, i, conf);
	int count = mask_label(label, mask, s->size, s->size);
	struct blob *blobs = mem_new((size_t)count + 1, sizeof *blobs);
	measure(blobs, label, s, conf);
	out->items = mem_new((size_t)count + 1, sizeof *out->items);
	for (int k = 1; k <= count; k++) {
		struct blob *b = &blobs[k];
		double confidence = b->seeded ? confidence_of(b, s->mm, conf) : 0;
		b->seeded = confidence > 0;
		if (b->seeded)
			out->items[out->n++] = (struct freckle){ b->x / b->weight * s->mm - s->sheet.extent,
				                                 b->y / b->weight * s->mm - s->sheet.extent,
				                                 (double)b->area * s->mm * s->mm, confidence };
	}
	for (long i = 0; i < n; i++) {
		const struct blob *b = &blobs[label[i]];
		if (label[i] && b->seeded)
			opacity[i] = opacity_of(s->ratio[i], b->peak, conf->edge);
	}
	free(blobs);
	free(label);
	free(mask);
}

/* The searched map's opacity, over the whole map. */
static void spread_opacity(struct freckles *out, const float *opacity, const struct search *s)
{
	double to = (double)s->size * s->step / s->size;
#pragma omp parallel for schedule(static)
	for (int row = 0; row < out->size; row++)
		for (int col = 0; col < out->size; col++)
			out->opacity[(long)row * out->size + col]
				= plane_sample(opacity, s->size, s->size, (col + 0.5) / to, (row + 0.5) / to);
}

struct freckles freckles_find(const struct image *rgbw, double extent, const struct circle *pupil, double limbus,
                              const struct freckle_conf *conf)
{
	int size = rgbw->width, step = (size + conf->max_size - 1) / conf->max_size;
	while (size % step)
		step++;
	struct search s = { .size = size / step, .step = step };
	size_t n = (size_t)s.size * (size_t)s.size;
	s.mm = 2 * extent * step / size;
	s.sheet = (struct sheet){ s.size, s.mm * s.size / 2, *pupil, limbus, 0 };
	float *planes = mem_new(8 * n, sizeof *planes), *opacity = planes + 7 * n;
	for (int c = 0; c < 3; c++)
		s.log[c] = planes + (size_t)c * n;
	s.ratio = planes + 3 * n, s.ratio_z = planes + 4 * n, s.fall[0] = planes + 5 * n, s.fall[1] = planes + 6 * n;
	s.use = mem_array(n, 1);
	reduce(&s, rgbw, conf->limbus_margin);
	take_logs(&s, conf->blur / s.mm);
	s.brown = median_ratio(&s);
	compare(&s);
	struct freckles out = { .size = size, .opacity = mem_new((size_t)size * (size_t)size, sizeof(float)) };
	// a brown iris has a freckle's colour already
	if (s.brown > (float)conf->brown)
		freckles_find_flat(&out, opacity, &s, conf);
	else
		find_coloured(&out, opacity, &s, conf);
	qsort(out.items, (size_t)out.n, sizeof *out.items, larger_first);
	if (out.n)
		spread_opacity(&out, opacity, &s);
	free(s.use);
	free(planes);
	return out;
}

void freckles_free(struct freckles *freckles)
{
	free(freckles->items);
	free(freckles->opacity);
	*freckles = (struct freckles){ 0 };
}

uint8_t *freckle_mask(const struct freckles *freckles, double extent, double blur)
{
	long n = (long)freckles->size * freckles->size;
	uint8_t *mask = mem_array((size_t)n, 1);
	for (long i = 0; i < n; i++)
		mask[i] = freckles->opacity[i] >= 0.25f;
	// the photograph's own blur, and the search's over the edge
	mask_grow(mask, freckles->size, freckles->size, 2 + 2 * blur * freckles->size / (2 * extent));
	return mask;
}
