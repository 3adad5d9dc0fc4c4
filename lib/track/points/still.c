/* How much the picture changes from frame to frame: what stands still is not measured again. */
#include <math.h>

#include "track/points/skin_track_impl.h"

enum { STILL_LEVEL = 2 };

static int still_level(const struct skin_track *t)
{
	return t->frame.levels - 1 < STILL_LEVEL ? t->frame.levels - 1 : STILL_LEVEL;
}

double skin_track_gain(const struct skin_track *t)
{
	const struct scales *a = &t->frame, *b = &t->last;
	const struct scale_level *p = &a->level[still_level(t)], *q = &b->level[still_level(t)];
	if (!t->has_last || a->x0 != b->x0 || a->y0 != b->y0 || p->width != q->width || p->height != q->height)
		return 0;
	double sa = 0, sb = 0;
	for (int y = 0; y < p->height; y++)
		for (int x = 0; x < p->width; x++) {
			sa += p->px[(long)y * p->stride + x];
			sb += q->px[(long)y * q->stride + x];
		}
	return sb > 0 ? sa / sb : 1;
}

/* Mean change from the frame before, after that gain. */
static double change(const struct skin_track *t, int x0, int y0, int x1, int y1)
{
	const struct scale_level *p = &t->frame.level[still_level(t)], *q = &t->last.level[still_level(t)];
	double d = 0;
	for (int y = y0; y < y1; y++)
		for (int x = x0; x < x1; x++)
			d += fabs(p->px[(long)y * p->stride + x] - t->gain * q->px[(long)y * q->stride + x]);
	return d / ((double)(x1 - x0) * (y1 - y0));
}

double skin_track_changed(const struct skin_track *t, const double at[2])
{
	const struct scale_level *p = &t->frame.level[still_level(t)];
	int size = 1 << still_level(t), x = ((int)at[0] - t->frame.x0) / size, y = ((int)at[1] - t->frame.y0) / size;
	int reach = (t->conf.radius + size - 1) / size;
	if (!(t->gain > 0) || x < reach || y < reach || x + reach >= p->width || y + reach >= p->height)
		return INFINITY;
	return change(t, x - reach, y - reach, x + reach + 1, y + reach + 1);
}

bool skin_track_stands_still(const struct skin_track *t)
{
	const struct scale_level *p = &t->frame.level[still_level(t)];
	return t->gain > 0 && change(t, 0, 0, p->width, p->height) < t->conf.still;
}
