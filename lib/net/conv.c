#include "net/conv.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "net/tile.h"

static int most(int a, int b)
{
	return a > b ? a : b;
}

static int tiles_of(const struct net_conv *c)
{
	return (c->out / c->groups + NET_TILE - 1) / NET_TILE;
}

void net_conv_make(struct net_conv *c, const void *weight, const void *bias)
{
	const int out = c->out / c->groups, taps = c->in / c->groups * c->height * c->width, tiles = tiles_of(c);
	c->weight = mem_new((size_t)c->groups * (size_t)tiles * (size_t)taps * NET_TILE, sizeof *c->weight);
	c->bias = mem_new((size_t)c->groups * (size_t)tiles * NET_TILE, sizeof *c->bias);
	for (int o = 0; o < c->out; o++) {
		const long tile = (long)(o / out) * tiles + o % out / NET_TILE, lane = o % out % NET_TILE;
		memcpy(&c->bias[tile * NET_TILE + lane], (const char *)bias + (size_t)o * sizeof(float), sizeof(float));
		for (int t = 0; t < taps; t++)
			memcpy(&c->weight[(tile * taps + t) * NET_TILE + lane], (const char *)weight + ((size_t)o * (size_t)taps + (size_t)t) * sizeof(float), sizeof(float));
	}
}

void net_conv_free(struct net_conv *c)
{
	free(c->weight);
	free(c->bias);
	c->weight = c->bias = 0;
}

struct net_size net_conv_size(const struct net_conv *c, struct net_size in)
{
	const int high = in.height + 2 * c->pad - c->height, wide = in.width + 2 * c->pad - c->width;
	return (struct net_size){ c->out, high < 0 ? 0 : high / c->stride + 1, wide < 0 ? 0 : wide / c->stride + 1 };
}

/* What a convolution reads: of each channel one plane, or, where it steps over pixels, a plane for each phase of the steps, in which its steps are 1.
 * Where rows are as far apart as those of the result, all of them are one row. */
struct source {
	const float *at;
	long pitch, channel;
	long tap[NET_CONV_TAPS];
};

static long phase_pitch(const struct net_conv *c, struct net_size out, int border)
{
	return out.width + most(border, (c->width - 1) / c->stride);
}

static long phase_plane(const struct net_conv *c, struct net_size out, int border)
{
	return (out.height + (c->height - 1) / c->stride) * phase_pitch(c, out, border);
}

size_t net_conv_floats(const struct net_conv *c, struct net_size in, int border)
{
	if (c->stride == 1)
		return 0;
	const struct net_size out = net_conv_size(c, in);
	return (size_t)((long)c->in * c->stride * c->stride * phase_plane(c, out, border)) + NET_PLANES_BEYOND;
}

static struct source direct(const struct net_conv *c, const struct net_planes *in)
{
	struct source s = { .at = in->px - c->pad * in->pitch - c->pad, .pitch = in->pitch, .channel = in->plane };
	for (int t = 0; t < c->height * c->width; t++)
		s.tap[t] = t / c->width * in->pitch + t % c->width;
	return s;
}

/* Every stride-th pixel of a plane, from (x, y) on. */
static void phase(float *to, long to_pitch, int height, int width, const float *from, long from_pitch, int stride)
{
	for (int i = 0; i < height; i++) {
		const float *row = from + (long)i * stride * from_pitch;
		if (stride == 2)
			for (int j = 0; j < width; j++)
				to[i * to_pitch + j] = row[2 * j];
		else
			for (int j = 0; j < width; j++)
				to[i * to_pitch + j] = row[(long)stride * j];
	}
}

static struct source phases(float *work, const struct net_conv *c, const struct net_planes *in, struct net_size out)
{
	const int n = c->stride;
	const long plane = phase_plane(c, out, in->border);
	struct source s = { .at = work, .pitch = phase_pitch(c, out, in->border), .channel = n * n * plane };
	for (int t = 0; t < c->height * c->width; t++) {
		const int i = t / c->width, j = t % c->width;
		s.tap[t] = (i % n * n + j % n) * plane + i / n * s.pitch + j / n;
	}
	for (int channel = 0; channel < c->in; channel++)
		for (int i = 0; i < n && i < c->height; i++)
			for (int j = 0; j < n && j < c->width; j++)
				phase(work + channel * s.channel + (i * n + j) * plane, s.pitch, out.height + (c->height - 1 - i) / n, out.width + (c->width - 1 - j) / n,
				      net_planes_row(in, channel, i - c->pad) + j - c->pad, in->pitch, n);
	return s;
}

static void tanh_of(const struct net_planes *p, int channel)
{
	for (int row = 0; row < p->size.height; row++) {
		float *px = net_planes_row(p, channel, row);
		for (int x = 0; x < p->size.width; x++)
			px[x] = tanhf(px[x]);
	}
}

void net_conv_run(const struct net_planes *out, const struct net_conv *c, const struct net_planes *in, float *work)
{
	const struct source s = c->stride == 1 ? direct(c, in) : phases(work, c, in, out->size);
	const int each = c->out / c->groups, taps = c->height * c->width, tiles = tiles_of(c), channels = c->in / c->groups;
	const bool one = s.pitch == out->pitch;
	const long rows = one ? 1 : out->size.height, n = one ? out->size.height * out->pitch - out->border : out->size.width;
	for (int g = 0; g < c->groups; g++)
		for (int t = 0; t < tiles; t++) {
			const int first = g * each + t * NET_TILE, count = each - t * NET_TILE < NET_TILE ? each - t * NET_TILE : NET_TILE;
			const struct net_tile tile = { .channels = channels, .taps = taps, .tap = s.tap, .channel = s.channel, .count = count,
				                       .weight = c->weight + ((long)g * tiles + t) * channels * taps * NET_TILE,
				                       .bias = c->bias + ((long)g * tiles + t) * NET_TILE, .plane = out->plane, .relu = c->act == NET_RELU };
			for (long row = 0; row < rows; row++)
				net_tile_run(net_planes_row(out, first, (int)row), &tile, s.at + g * channels * s.channel + row * s.pitch, n);
			for (int o = first; o < first + count; o++) {
				net_planes_seal(out, o);
				if (c->act == NET_TANH)
					tanh_of(out, o);
			}
		}
}
