#include "track/points/track.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "track/points/track_impl.h"

enum { STEP = 64 };

/* Patches and the search round them must stay inside the window that is kept of a frame. */
static void window(int box[4], const struct skin_track *t)
{
	double lo[2] = { t->width, t->height }, hi[2] = { 0, 0 };
	for (int i = 0; i < t->points.n; i++)
		for (int k = 0; k < 2; k++) {
			lo[k] = fmin(lo[k], t->point[i].warp.at[k]);
			hi[k] = fmax(hi[k], t->point[i].warp.at[k]);
		}
	// in steps, so that it mostly stays the same from frame to frame
	int margin = (t->conf.radius + 6) << (t->conf.levels - 1);
	for (int k = 0; k < 2; k++) {
		box[k] = (int)floor((lo[k] - margin) / STEP) * STEP;
		box[2 + k] = (int)ceil((hi[k] + margin) / STEP) * STEP;
	}
}

static void fill(struct scales *p, const struct skin_track *t, const uint8_t *luma, int stride)
{
	int box[4];
	window(box, t);
	scales_fill(p, luma, stride, t->width, t->height, box[0], box[1], box[2] > box[0] ? box[2] : box[0] + 1,
	             box[3] > box[1] ? box[3] : box[1] + 1, t->conf.levels);
}

void skin_track_restart(struct skin_track *t)
{
	for (int i = 0; i < t->points.n; i++) {
		struct skin_warp *p = &t->point[i];
		*p = (struct skin_warp){ .warp = { { t->points.at[i][0], t->points.at[i][1] }, { { 1, 0 }, { 0, 1 } } }, .seen = 1, .usual = 1 };
		p->before = p->warp;
	}
	t->has_last = false;
}

static struct skin_points copy_points(const struct skin_points *from)
{
	int links = from->first[from->n];
	struct skin_points to = { .n = from->n };
	to.at = mem_new((size_t)from->n + 1, sizeof *to.at);
	to.first = mem_new((size_t)from->n + 1, sizeof *to.first);
	to.near = mem_new((size_t)links + 1, sizeof *to.near);
	memcpy(to.at, from->at, (size_t)from->n * sizeof *to.at);
	memcpy(to.first, from->first, ((size_t)from->n + 1) * sizeof *to.first);
	memcpy(to.near, from->near, (size_t)links * sizeof *to.near);
	return to;
}

struct skin_track *skin_track_new(const struct skin_points *points, const uint8_t *luma, int stride, int width, int height,
                                  const uint8_t *mask, const struct skin_track_conf *conf)
{
	struct skin_track *t = mem_new(1, sizeof *t);
	t->conf = *conf;
	t->width = width;
	t->height = height;
	t->points = copy_points(points);
	t->point = mem_new((size_t)points->n + 1, sizeof *t->point);
	t->field = mem_new((size_t)points->n + 1, sizeof *t->field);
	skin_track_restart(t);
	fill(&t->frame, t, luma, stride);
	const struct scale_level *l = &t->frame.level[0];
	float *weight = mask ? mem_new((size_t)l->stride * (size_t)l->height, sizeof *weight) : 0;
	for (int y = 0; weight && y < l->height; y++)
		for (int x = 0; x < l->width; x++)
			weight[(long)y * l->stride + x] = mask[(long)(t->frame.y0 + y) * width + t->frame.x0 + x] / 255.0f;
	const struct patch_conf patch = { conf->radius, conf->every, conf->iterations, conf->stop, conf->noise, conf->misfit };
	t->patches = patch_set_new(&t->frame, points->n, points->at, weight, &patch);
	free(weight);
	return t;
}

void skin_track_free(struct skin_track *t)
{
	if (!t)
		return;
	patch_set_free(t->patches);
	scales_free(&t->frame);
	scales_free(&t->last);
	skin_points_free(&t->points);
	free(t->point);
	free(t->field);
	free(t);
}

bool skin_track_was_still(const struct skin_track *t)
{
	return t->was_still;
}

enum { STILL_LEVEL = 2 };

static int still_level(const struct skin_track *t)
{
	return t->frame.levels - 1 < STILL_LEVEL ? t->frame.levels - 1 : STILL_LEVEL;
}

/* What the frame before has to be multiplied by to be as bright as this one; 0 where their windows differ. */
static double gain_of(const struct skin_track *t)
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

/* Changes add up until they are seen: the frame before is the last that was worked on. */
static bool stands_still(const struct skin_track *t)
{
	const struct scale_level *p = &t->frame.level[still_level(t)];
	return t->gain > 0 && change(t, 0, 0, p->width, p->height) < t->conf.still;
}

double skin_track_push(struct skin_track *t, const uint8_t *luma, int stride, struct skin_point_state *state)
{
	struct scales swap = t->last;
	t->last = t->frame;
	t->frame = swap;
	fill(&t->frame, t, luma, stride);
	t->gain = gain_of(t);
	t->was_still = stands_still(t);
	if (t->was_still) {
		// compared with the frame that was worked on, so that slow motion adds up until it is seen
		swap = t->last;
		t->last = t->frame;
		t->frame = swap;
	} else {
		skin_track_follow(t);
	}
	t->has_last = true;
	double seen = 0;
	for (int i = 0; i < t->points.n; i++) {
		const struct skin_warp *p = &t->point[i];
		state[i] = (struct skin_point_state){ { p->best[0], p->best[1] }, p->confidence, p->ncc };
		seen += p->confidence > 0;
	}
	return t->points.n ? seen / t->points.n : 0;
}
