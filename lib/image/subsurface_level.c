#include "image/subsurface_level.h"

#include <assert.h>
#include <math.h>
#include <omp.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "math/simd.h"

#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC optimize("fp-contract=fast")  // see math/simd.h
#endif

enum { LANES = SUBSURFACE_LANES };
typedef subsurface_lanes lanes;
typedef int mask __attribute__((vector_size(32)));

static int rounded(int n)
{
	return (n + LANES - 1) / LANES * LANES;
}

void subsurface_taps_gauss(struct subsurface_taps *t, double variance)
{
	double sum = 0, w[2 * SUBSURFACE_RADIUS + 1], inner = variance;
	t->radius = (int)fmin(fmax(ceil(2.3 * sqrt(variance)), 1), SUBSURFACE_RADIUS);
	for (int round = 0; round < 20; round++) {  // what is cut off is made up for: the taps' own variance is the one asked for
		double second = 0;
		sum = 0;
		for (int k = -t->radius; k <= t->radius; k++) {
			sum += w[k + t->radius] = exp(-k * k / (2 * inner));
			second += k * k * w[k + t->radius];
		}
		inner *= variance * sum / second;
	}
	for (int k = 0; k <= 2 * t->radius; k++)
		t->weight[k] = (float)(w[k] / sum);
}

void subsurface_level_top(struct subsurface_level *l, const struct subsurface_picture *p)
{
	*l = (struct subsurface_level){ p->width, p->height, p->width, { p->rgb[0], p->rgb[1], p->rgb[2] }, .z = p->depth };
}

void subsurface_room_make(struct subsurface_room *room, size_t n)
{
	if (room->n < n) {
		free(room->px);
		*room = (struct subsurface_room){ mem_array(n, sizeof *room->px), n, 0 };
	}
	room->used = 0;
}

void subsurface_room_free(struct subsurface_room *room)
{
	free(room->px);
	*room = (struct subsurface_room){ 0 };
}

float *subsurface_room_take(struct subsurface_room *room, size_t n)
{
	float *px = room->px + room->used;
	room->used += (n + 15) / 16 * 16;
	assert(room->used <= room->n);
	return px;
}

/* Taps [from, to] of n texels; a step apart. */
struct line {
	const float *in[3], *z;
	float *out[3];
	int n, step, from, to, channels;  // the first so many
	bool adds[3];
	float gain[3];
};

SIMD_INLINE void tap(const struct line *l, const struct subsurface_taps *t, float inv_8v, int channels)
{
	const float *restrict z = l->z, *restrict in[3] = { l->in[0], l->in[1], l->in[2] }, *restrict weight = t->weight + t->radius;
	const int from = l->from, to = l->to;
	const long step = l->step;
	const lanes zero = { 0 };
	for (int x = 0; x < l->n; x += LANES) {
		lanes here = *(const lanes *)(z + x), sum[3] = { zero, zero, zero }, all = zero;
		for (int k = from; k <= to; k++) {
			long at = x + k * step;
			// exp(-dz² / 2v) as (1 - dz² / 8v)^4, 0 beyond: within 0.02 of it.
			lanes dz = *(const lanes *)(z + at) - here, f = 1 - dz * dz * inv_8v;
			f = (lanes)((mask)f & (f > 0));
			f *= f;
			f = weight[k] * (f * f);
			all += f;
			for (int c = 0; c < channels; c++)
				sum[c] += f * *(const lanes *)(in[c] + at);
		}
		all = 1 / all;  // the middle one is always there
		for (int c = 0; c < channels; c++) {
			lanes *out = (lanes *)(l->out[c] + x), now = sum[c] * all * l->gain[c];
			*out = l->adds[c] ? *out + now : now;
		}
	}
}

SIMD_CLONES static void along(const struct line *l, const struct subsurface_taps *t, float inv_8v)
{
	if (l->channels == 1)
		tap(l, t, inv_8v, 1);
	else if (l->channels == 2)
		tap(l, t, inv_8v, 2);
	else
		tap(l, t, inv_8v, 3);
}

/* Rows in [0, n) padded on both sides by nothing. */
static void pad(float *out, const float *in, int n, int stride, int side)
{
	memset(out, 0, (size_t)side * sizeof *out);
	memcpy(out + side, in, (size_t)n * sizeof *out);
	memset(out + side + n, 0, (size_t)(stride - n + side) * sizeof *out);
}

/* A thread's rows on their way: blurred along x, from `radius` above a band to as many below it; planes r, g, b, z. */
enum { BAND = 16 };

struct band {
	float *plane[4], *padded;  // padded: room for one row of each
	int y, rows;               // the screen's row of the first; rows in all
};

size_t subsurface_band_size(int width)
{
	return 4 * ((size_t)(BAND + 2 * SUBSURFACE_RADIUS) * (size_t)rounded(width) + (size_t)(rounded(width) + 2 * SUBSURFACE_RADIUS));
}

static struct band band_in(float *room, int stride, int radius)
{
	size_t n = (size_t)(BAND + 2 * radius) * (size_t)stride, wide = (size_t)(stride + 2 * SUBSURFACE_RADIUS);
	struct band b = { .padded = room };
	for (int c = 0; c < 4; c++)
		b.plane[c] = room + 4 * wide + (size_t)c * n;
	return b;
}

/* One row of the level along x into the band. */
static void blur_x(const struct band *b, int y, const struct subsurface_level *l, const struct subsurface_taps *t, float inv_8v, int channels,
                   int stride)
{
	int side = SUBSURFACE_RADIUS, wide = stride + 2 * side;
	size_t from = (size_t)y * (size_t)l->stride, to = (size_t)(y - b->y) * (size_t)stride;
	struct line line = { .z = b->padded + 3 * wide + side, .n = stride, .step = 1, .from = -t->radius, .to = t->radius, .channels = channels };
	pad(b->padded + 3 * wide, l->z + from, l->width, stride, side);
	memcpy(b->plane[3] + to, line.z, (size_t)stride * sizeof *b->padded);
	for (int c = 0; c < channels; c++) {
		pad(b->padded + c * wide, l->rgb[c] + from, l->width, stride, side);
		line.in[c] = b->padded + c * wide + side;
		line.out[c] = b->plane[c] + to;
		line.gain[c] = 1;
	}
	along(&line, t, inv_8v);
}

/* Moves the band on to the rows that [y, end) needs; those that it has already are kept. */
static void band_move(struct band *b, int y, int end, const struct subsurface_level *l, const struct subsurface_taps *t, float inv_8v, int channels,
                      int stride)
{
	int from = y > t->radius ? y - t->radius : 0, to = end + t->radius < l->height ? end + t->radius : l->height;
	int had = b->y + b->rows, kept = had > from ? had - from : 0;
	for (int c = 0; c < 4 && kept; c++)
		memmove(b->plane[c], b->plane[c] + (size_t)(from - b->y) * (size_t)stride, (size_t)kept * (size_t)stride * sizeof *b->padded);
	b->y = from;
	b->rows = to - from;
	for (int row = from + kept; row < to; row++)
		blur_x(b, row, l, t, inv_8v, channels, stride);
}

/* Both ways a band at a time: what lies between the two never leaves the cache next to the core. */
void subsurface_blur(struct subsurface_level *l, const struct subsurface_taps *t, double variance, const double weight[3],
                     struct subsurface_room *room)
{
	int stride = rounded(l->width), channels = weight[2] > 0 ? 3 : weight[1] > 0 ? 2 : 1, bands = (l->height + BAND - 1) / BAND;
	size_t n = (size_t)stride * (size_t)l->height, each = subsurface_band_size(l->width);
	bool first = !l->sum[0];
	float inv_8v = (float)(1 / (8 * variance));
	for (int c = 0; c < 3 && first; c++) {
		l->sum[c] = subsurface_room_take(room, n);
		if (c >= channels)
			memset(l->sum[c], 0, n * sizeof *l->sum[c]);
	}
	size_t back = room->used;
	float *bands_room = subsurface_room_take(room, (size_t)omp_get_max_threads() * each);
#pragma omp parallel
	{
		struct band band = band_in(bands_room + (size_t)omp_get_thread_num() * each, stride, t->radius);
#pragma omp for schedule(static)
		for (int k = 0; k < bands; k++) {
			int end = (k + 1) * BAND < l->height ? (k + 1) * BAND : l->height;
			band_move(&band, k * BAND, end, l, t, inv_8v, channels, stride);
			for (int y = k * BAND; y < end; y++) {
				size_t at = (size_t)(y - band.y) * (size_t)stride;
				struct line line = { .z = band.plane[3] + at, .n = stride, .step = stride, .channels = channels };
				line.from = y < t->radius ? -y : -t->radius;
				line.to = l->height - 1 - y < t->radius ? l->height - 1 - y : t->radius;
				for (int c = 0; c < channels; c++) {
					line.in[c] = band.plane[c] + at;
					line.out[c] = l->sum[c] + (size_t)y * (size_t)stride;
					line.gain[c] = (float)weight[c];
					line.adds[c] = !first;
				}
				along(&line, t, inv_8v);
			}
		}
	}
	room->used = back;
}

void subsurface_level_give(struct subsurface_level *l, const double stays[3])
{
	int stride = rounded(l->width);
#pragma omp parallel for schedule(static)
	for (int y = 0; y < l->height; y++) {
		const float *z = l->z + (size_t)y * (size_t)l->stride;
		for (int c = 0; c < 3; c++) {
			float *px = l->rgb[c] + (size_t)y * (size_t)l->stride, keep = (float)stays[c];
			const float *sum = l->sum[c] + (size_t)y * (size_t)stride;
			SIMD_LOOP
			for (int i = 0; i < l->width; i++)
				px[i] = z[i] > 0 ? keep * px[i] + sum[i] : px[i];
		}
	}
}
