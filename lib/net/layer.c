#include "net/layer.h"

#include <string.h>

static void scale_row(float *out, const float *in, int width, float gain, float offset)
{
	for (int x = 0; x < width; x++)
		out[x] = gain * in[x] + offset;
}

static void add_row(float *out, const float *a, const float *b, int width, bool doubled)
{
	if (doubled)
		for (int x = 0; x < width / 2; x++) {
			out[2 * x] = a[x] + b[2 * x];
			out[2 * x + 1] = a[x] + b[2 * x + 1];
		}
	else
		for (int x = 0; x < width; x++)
			out[x] = a[x] + b[x];
}

/* The means of windows side by side, along one row of the result. */
static void mean_row(float *out, const struct net_planes *in, int channel, int row, const struct net_layer *l, int width)
{
	memset(out, 0, (size_t)width * sizeof *out);
	for (int i = 0; i < l->height; i++) {
		const float *px = net_planes_row(in, channel, row * l->height + i);
		for (int x = 0; x < width; x++)
			for (int j = 0; j < l->width; j++)
				out[x] += px[x * l->width + j];
	}
	for (int x = 0; x < width; x++)
		out[x] /= (float)(l->height * l->width);
}

void net_layer_run(const struct net_planes *out, const struct net_layer *l, const struct net_planes *a, const struct net_planes *b, float *work)
{
	const int width = out->size.width, by = l->doubled ? 2 : 1;
	if (l->kind == NET_CONV) {
		net_conv_run(out, &l->conv, a, work);
		return;
	}
	for (int c = 0; c < out->size.channels; c++)
		for (int y = 0; y < out->size.height; y++) {
			float *row = net_planes_row(out, c, y);
			if (l->kind == NET_SCALE)
				scale_row(row, net_planes_row(a, c, y), width, l->gain, l->offset);
			else if (l->kind == NET_ADD)
				add_row(row, net_planes_row(a, c, y / by), net_planes_row(b, c, y), width, l->doubled);
			else if (l->kind == NET_MEAN)
				mean_row(row, a, c, y, l, width);
			else
				memcpy(row, y < a->size.height ? net_planes_row(a, c, y) : net_planes_row(b, c, y - a->size.height), (size_t)width * sizeof *row);
		}
}
