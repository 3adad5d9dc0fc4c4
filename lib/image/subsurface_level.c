#include "image/subsurface_level.h"

#include <assert.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "math/simd.h"

enum { LANES = 8 };
typedef float lanes __attribute__((vector_size(32), aligned(4)));
typedef int mask __attribute__((vector_size(32)));

static int rounded(int n)
{
	return (n + LANES - 1) / LANES * LANES;
}

void subsurface_taps_gauss(struct subsurface_taps *t, double variance)
{
	double sum = 0, w[2 * SUBSURFACE_RADIUS + 1];
	t->radius = (int)fmin(fmax(ceil(3 * sqrt(variance)), 1), SUBSURFACE_RADIUS);
	for (int k = -t->radius; k <= t->radius; k++)
		sum += w[k + t->radius] = exp(-k * k / (2 * variance));
	for (int k = 0; k <= 2 * t->radius; k++)
		t->weight[k] = (float)(w[k] / sum);
}

void subsurface_level_top(struct subsurface_level *l, const struct subsurface_picture *p)
{
	*l = (struct subsurface_level){ p->width, p->height, p->width, { p->rgb[0], p->rgb[1], p->rgb[2] }, p->depth, { 0 } };
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

/* One texel out of four, with their shares: those about as near as the nearest. */
struct quad {
	float a, b, c, d;
};

SIMD_INLINE float depth_or_far(float z)
{
	return z > 0 ? z : 1e30f;
}

SIMD_INLINE float least(float a, float b)
{
	return a < b ? a : b;
}

SIMD_INLINE struct quad shares(float *depth, float a, float b, float c, float d, float gap)
{
	float fa = depth_or_far(a), fb = depth_or_far(b), fc = depth_or_far(c), fd = depth_or_far(d);
	float front = least(least(fa, fb), least(fc, fd)) + gap;
	struct quad q = { fa < front ? 1 : 0, fb < front ? 1 : 0, fc < front ? 1 : 0, fd < front ? 1 : 0 };
	float n = (q.a + q.b) + (q.c + q.d), each = 1 / (n > 0 ? n : 1);
	q = (struct quad){ q.a * each, q.b * each, q.c * each, q.d * each };
	*depth = (q.a * a + q.b * b) + (q.c * c + q.d * d);
	return q;
}

/* Rows 2y and 2y + 1 of the level above, of twice n texels. */
struct pair {
	const float *z[2], *rgb[2][3];
	float *z_out, *rgb_out[3];
};

SIMD_CLONES static void halve_row(const struct pair *p, int n, float gap)
{
	const float *a = p->z[0], *b = p->z[1], *r0 = p->rgb[0][0], *r1 = p->rgb[1][0];
	const float *g0 = p->rgb[0][1], *g1 = p->rgb[1][1], *b0 = p->rgb[0][2], *b1 = p->rgb[1][2];
	float *z = p->z_out, *r = p->rgb_out[0], *g = p->rgb_out[1], *blue = p->rgb_out[2];
	SIMD_LOOP
	for (int i = 0; i < n; i++) {
		struct quad q = shares(&z[i], a[2 * i], a[2 * i + 1], b[2 * i], b[2 * i + 1], gap);
		r[i] = (q.a * r0[2 * i] + q.b * r0[2 * i + 1]) + (q.c * r1[2 * i] + q.d * r1[2 * i + 1]);
		g[i] = (q.a * g0[2 * i] + q.b * g0[2 * i + 1]) + (q.c * g1[2 * i] + q.d * g1[2 * i + 1]);
		blue[i] = (q.a * b0[2 * i] + q.b * b0[2 * i + 1]) + (q.c * b1[2 * i] + q.d * b1[2 * i + 1]);
	}
}

/* The last column of an odd width, alone. */
static void halve_last(const struct pair *p, int i, float gap)
{
	struct quad q = shares(&p->z_out[i], p->z[0][2 * i], 0, p->z[1][2 * i], 0, gap);
	for (int c = 0; c < 3; c++)
		p->rgb_out[c][i] = q.a * p->rgb[0][c][2 * i] + q.c * p->rgb[1][c][2 * i];
}

void subsurface_level_halve(struct subsurface_level *l, const struct subsurface_level *above, double texels_per_mm,
                            struct subsurface_room *room)
{
	*l = (struct subsurface_level){ .width = (above->width + 1) / 2, .height = (above->height + 1) / 2 };
	l->stride = rounded(l->width);
	size_t n = (size_t)l->stride * (size_t)l->height;
	for (int c = 0; c < 3; c++)
		l->rgb[c] = subsurface_room_take(room, n);
	float *z = subsurface_room_take(room, n);
	l->z = z;
	float gap = (float)(4 / texels_per_mm);  // a surface seen at 60 degrees falls by 2.4 texels across their diagonal
#pragma omp parallel for schedule(static)
	for (int y = 0; y < l->height; y++) {
		struct pair p;
		size_t to = (size_t)y * (size_t)l->stride;
		for (int k = 0; k < 2; k++) {
			int row = 2 * y + k < above->height ? 2 * y + k : 2 * y;  // counted twice, the last of an odd height
			size_t from = (size_t)row * (size_t)above->stride;
			p.z[k] = above->z + from;
			for (int c = 0; c < 3; c++)
				p.rgb[k][c] = above->rgb[c] + from;
		}
		p.z_out = z + to;
		for (int c = 0; c < 3; c++)
			p.rgb_out[c] = l->rgb[c] + to;
		halve_row(&p, above->width / 2, gap);
		if (above->width % 2)
			halve_last(&p, l->width - 1, gap);
		for (int i = l->width; i < l->stride; i++)
			p.z_out[i] = p.rgb_out[0][i] = p.rgb_out[1][i] = p.rgb_out[2][i] = 0;
	}
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

static void blur_x(float *const out[3], float *z_out, const struct subsurface_level *l, const struct subsurface_taps *t, float inv_8v,
                   int channels, int stride)
{
#pragma omp parallel
	{
		int side = SUBSURFACE_RADIUS, wide = stride + 2 * side;
		float *row = mem_array(4 * (size_t)wide, sizeof *row);
#pragma omp for schedule(static)
		for (int y = 0; y < l->height; y++) {
			size_t from = (size_t)y * (size_t)l->stride, to = (size_t)y * (size_t)stride;
			struct line line = { .z = row + 3 * wide + side, .n = stride, .step = 1, .from = -t->radius, .to = t->radius,
				             .channels = channels };
			pad(row + 3 * wide, l->z + from, l->width, stride, side);
			memcpy(z_out + to, line.z, (size_t)stride * sizeof *z_out);
			for (int c = 0; c < channels; c++) {
				pad(row + c * wide, l->rgb[c] + from, l->width, stride, side);
				line.in[c] = row + c * wide + side;
				line.out[c] = out[c] + to;
				line.gain[c] = 1;
			}
			along(&line, t, inv_8v);
		}
		free(row);
	}
}

void subsurface_blur(struct subsurface_level *l, const struct subsurface_taps *t, double variance, const double weight[3],
                     struct subsurface_room *room)
{
	int stride = rounded(l->width);
	size_t n = (size_t)stride * (size_t)l->height;
	int channels = weight[2] > 0 ? 3 : weight[1] > 0 ? 2 : 1;
	bool first = !l->sum[0];
	for (int c = 0; c < 3 && first; c++) {
		l->sum[c] = subsurface_room_take(room, n);
		if (c >= channels)
			memset(l->sum[c], 0, n * sizeof *l->sum[c]);
	}
	size_t back = room->used;
	float *between[3] = { 0 }, *z = subsurface_room_take(room, n), inv_8v = (float)(1 / (8 * variance));
	for (int c = 0; c < channels; c++)
		between[c] = subsurface_room_take(room, n);
	blur_x(between, z, l, t, inv_8v, channels, stride);
#pragma omp parallel for schedule(static)
	for (int y = 0; y < l->height; y++) {
		size_t at = (size_t)y * (size_t)stride;
		struct line line = { .z = z + at, .n = stride, .step = stride, .channels = channels };
		line.from = y < t->radius ? -y : -t->radius;
		line.to = l->height - 1 - y < t->radius ? l->height - 1 - y : t->radius;
		for (int c = 0; c < channels; c++) {
			line.in[c] = between[c] + at;
			line.out[c] = l->sum[c] + at;
			line.gain[c] = (float)weight[c];
			line.adds[c] = !first;
		}
		along(&line, t, inv_8v);
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
