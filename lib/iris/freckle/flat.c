#include "iris/freckle/flat.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "image/mask.h"
#include "image/plane.h"

/* Lengths in mm. The surroundings begin where the blur of a spot's edge ends. */
static const double smooth = 0.03, opening = 0.07, rim = 0.03, gap = 0.05, reach = 0.14, ragged = 0.035;

/* A candidate in its own box of the searched map. */
struct spot {
	int x0, y0, w, h;
	long n;               // texels of the seed
	double x, y, length;  // middle, px; length over width
	uint8_t *mask;        // [h][w] the seed, then the spot
};

struct quartiles {
	double low, middle, high;
};

static int by_value(const void *a, const void *b)
{
	float x = *(const float *)a, y = *(const float *)b;
	return (x > y) - (x < y);
}

/* Of the plane over the box' texels with mask set. */
static struct quartiles quartiles_of(const float *plane, const uint8_t *mask, const struct spot *spot,
                                     const struct search *s)
{
	long n = 0;
	float *v = mem_array((size_t)spot->w * (size_t)spot->h, sizeof *v);
	for (int y = 0; y < spot->h; y++)
		for (int x = 0; x < spot->w; x++) {
			long i = (long)(spot->y0 + y) * s->size + spot->x0 + x;
			if (mask[y * spot->w + x] && s->use[i])
				v[n++] = plane[i];
		}
	qsort(v, (size_t)n, sizeof *v, by_value);
	struct quartiles q = { NAN, NAN, NAN };
	if (n >= 20)
		q = (struct quartiles){ v[n / 4], v[n / 2], v[n * 3 / 4] };
	free(v);
	return q;
}

static uint8_t *grown(const struct spot *spot, double radius)
{
	size_t n = (size_t)spot->w * (size_t)spot->h;
	uint8_t *mask = mem_array(n, 1);
	memcpy(mask, spot->mask, n);
	mask_grow(mask, spot->w, spot->h, radius);
	return mask;
}

/* Second moments: middle, and length over width. */
static void moments(struct spot *spot)
{
	double n = 0, x = 0, y = 0, xx = 0, xy = 0, yy = 0;
	for (int j = 0; j < spot->h; j++)
		for (int i = 0; i < spot->w; i++)
			if (spot->mask[j * spot->w + i])
				n++, x += i, y += j, xx += (double)i * i, xy += (double)i * j, yy += (double)j * j;
	x /= n, y /= n;
	xx = xx / n - x * x, xy = xy / n - x * y, yy = yy / n - y * y;
	double mean = (xx + yy) / 2, diff = hypot((xx - yy) / 2, xy);
	spot->length = sqrt((mean + diff) / fmax(mean - diff, 1e-6));
	spot->n = (long)n;
	spot->x = spot->x0 + x + 0.5;
	spot->y = spot->y0 + y + 0.5;
}

/* Statistics of a patch: inside against the band around it. */
struct look {
	struct quartiles in, out;  // log green
	double red;                // rise of log(red / green)
};

static struct look look_at(const struct spot *spot, const float *level, const struct search *s)
{
	struct look look;
	uint8_t *core = grown(spot, -rim / s->mm), *near = grown(spot, gap / s->mm), *far = grown(spot, reach / s->mm);
	for (long i = 0; i < (long)spot->w * spot->h; i++)
		far[i] = far[i] && !near[i];
	look.in = quartiles_of(level, core, spot, s);
	look.out = quartiles_of(level, far, spot, s);
	look.red = quartiles_of(s->ratio, core, spot, s).middle - quartiles_of(s->ratio, far, spot, s).middle;
	free(core);
	free(near);
	free(far);
	return look;
}

/* Confidence: 0 when one of the tests fails, else from their margins. Melanin lowers green at least as much as red. */
static double confidence_of(const struct spot *spot, const struct look *look, double mm,
                            const struct freckle_conf *conf)
{
	const double red_least = -0.04;
	double flat = 1 - (look->in.high - look->in.low) / (look->out.high - look->out.low) / conf->flat_spread;
	double dark = (look->out.middle - look->in.middle) / conf->flat_darker - 1;
	double area = (double)spot->n * mm * mm / conf->flat_area - 1, round = conf->flat_long / spot->length - 1;
	double margin = fmin(fmin(2 * flat, dark), fmin(area, 3 * round));
	return margin > 0 && look->red > red_least ? 1 - 0.5 * exp(-2 * margin) : 0;
}

/* Segments a spot at the level half way between inside and around; parts that hang on it by a narrow neck are cut off
 * (opening). */
static void find_edge(struct spot *spot, const struct look *look, const float *level, const struct search *s)
{
	double half = (look->in.middle + look->out.middle) / 2;
	uint8_t *near = grown(spot, gap * 2 / s->mm);
	for (int y = 0; y < spot->h; y++)
		for (int x = 0; x < spot->w; x++) {
			long i = (long)(spot->y0 + y) * s->size + spot->x0 + x, k = (long)y * spot->w + x;
			near[k] = near[k] && s->use[i] && level[i] < half;
		}
	mask_grow(near, spot->w, spot->h, -ragged / s->mm);
	mask_grow(near, spot->w, spot->h, ragged / s->mm);
	int *label = mem_array((size_t)spot->w * (size_t)spot->h, sizeof *label);
	int count = mask_label(label, near, spot->w, spot->h);
	uint8_t *meets = mem_new((size_t)count + 1, 1);
	for (long k = 0; k < (long)spot->w * spot->h; k++)
		meets[label[k]] |= spot->mask[k];
	for (long k = 0; k < (long)spot->w * spot->h; k++)
		spot->mask[k] = label[k] && meets[label[k]];
	free(meets);
	free(label);
	free(near);
}

static struct spot spot_open(const int *label, int k, const int box[4], const struct search *s)
{
	int margin = (int)ceil(reach / s->mm) + 2;
	struct spot spot = { .x0 = box[0] > margin ? box[0] - margin : 0, .y0 = box[1] > margin ? box[1] - margin : 0 };
	spot.w = (box[2] + margin < s->size ? box[2] + margin + 1 : s->size) - spot.x0;
	spot.h = (box[3] + margin < s->size ? box[3] + margin + 1 : s->size) - spot.y0;
	spot.mask = mem_array((size_t)spot.w * (size_t)spot.h, 1);
	for (int y = 0; y < spot.h; y++)
		for (int x = 0; x < spot.w; x++)
			spot.mask[y * spot.w + x] = label[(long)(spot.y0 + y) * s->size + spot.x0 + x] == k;
	moments(&spot);
	return spot;
}

static void consider(struct freckles *out, float *opacity, struct spot *spot, const float *level,
                     const struct search *s, const struct freckle_conf *conf)
{
	struct look look = look_at(spot, level, s);
	double confidence = confidence_of(spot, &look, s->mm, conf);
	if (!(confidence > 0))
		return;
	find_edge(spot, &look, level, s);
	moments(spot);
	out->items[out->n++] = (struct freckle){ spot->x * s->mm - s->sheet.extent, spot->y * s->mm - s->sheet.extent,
		                                 (double)spot->n * s->mm * s->mm, confidence };
	for (int y = 0; y < spot->h; y++)
		for (int x = 0; x < spot->w; x++)
			if (spot->mask[y * spot->w + x])
				opacity[(long)(spot->y0 + y) * s->size + spot->x0 + x] = 1;
}

void freckles_find_flat(struct freckles *out, float *opacity, const struct search *s, const struct freckle_conf *conf)
{
	long n = (long)s->size * s->size;
	float *level = mem_array((size_t)n, sizeof *level), *fall = mem_array((size_t)n, sizeof *fall);
	float *weight = mem_array((size_t)n, sizeof *weight);
	uint8_t *mask = mem_array((size_t)n, 1);
	int *label = mem_array((size_t)n, sizeof *label);
	for (long i = 0; i < n; i++) {
		weight[i] = s->use[i];
		level[i] = s->log[1][i];
		fall[i] = s->fall[1][i];
	}
	plane_blur_weighted(level, weight, s->size, s->size, smooth / s->mm, 0);
	plane_blur_weighted(fall, weight, s->size, s->size, smooth / s->mm, 0);
	for (long i = 0; i < n; i++)
		mask[i] = s->use[i] && fall[i] < -(float)conf->flat_darker;
	mask_grow(mask, s->size, s->size, -opening / s->mm);
	mask_grow(mask, s->size, s->size, opening / s->mm);
	int count = mask_label(label, mask, s->size, s->size);
	int(*box)[4] = mem_array((size_t)count + 1, sizeof *box);
	for (int k = 0; k <= count; k++)
		box[k][0] = box[k][1] = s->size, box[k][2] = box[k][3] = -1;
	for (long i = 0; i < n; i++) {
		int *b = box[label[i]], x = (int)(i % s->size), y = (int)(i / s->size);
		b[0] = x < b[0] ? x : b[0], b[2] = x > b[2] ? x : b[2];
		b[1] = y < b[1] ? y : b[1], b[3] = y > b[3] ? y : b[3];
	}
	out->items = mem_new((size_t)count + 1, sizeof *out->items);
	for (int k = 1; k <= count; k++) {
		struct spot spot = spot_open(label, k, box[k], s);
		consider(out, opacity, &spot, level, s, conf);
		free(spot.mask);
	}
	plane_blur(opacity, s->size, s->size, 1);
	free(box);
	free(label);
	free(mask);
	free(weight);
	free(fall);
	free(level);
}
