#include "net/planes.h"

#include <string.h>

static long plane_of(struct net_size size, int border)
{
	return (long)(size.height + 2 * border) * (size.width + border) + border;
}

size_t net_planes_floats(struct net_size size, int border)
{
	return (size_t)(size.channels * plane_of(size, border)) + NET_PLANES_BEYOND;
}

float *net_planes_row(const struct net_planes *p, int channel, int row)
{
	return p->px + channel * p->plane + row * p->pitch;
}

void net_planes_seal(const struct net_planes *p, int channel)
{
	for (int x = 0; x < p->border; x++)
		for (int row = 0; row < p->size.height; row++)
			net_planes_row(p, channel, row)[p->size.width + x] = 0;
}

struct net_planes net_planes_in(float *floats, struct net_size size, int border)
{
	struct net_planes p = { size, border, size.width + border, plane_of(size, border), 0 };
	const long above = border * p.pitch + border;
	p.px = floats + above;
	for (int c = 0; c < size.channels; c++) {
		float *plane = floats + c * p.plane, *below = plane + above + size.height * p.pitch - border;
		memset(plane, 0, (size_t)above * sizeof *plane);
		memset(below, 0, (size_t)(plane + p.plane - below) * sizeof *plane);
		net_planes_seal(&p, c);
	}
	memset(floats + size.channels * p.plane, 0, NET_PLANES_BEYOND * sizeof *floats);
	return p;
}
