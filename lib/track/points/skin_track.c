#include "track/points/skin_track.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "track/points/skin_track_impl.h"

enum { STEP = 64 };

/* The window kept of a frame: patches and the search round them. */
static void window(int box[4], const struct skin_track *t)
{
	double lo[2] = { t->width, t->height }, hi[2] = { 0, 0 };
	for (int i = 0; i < t->points.n; i++)
		for (int k = 0; k < 2; k++) {
			lo[k] = fmin(lo[k], t->point[i].warp.at[k]);
			hi[k] = fmax(hi[k], t->point[i].warp.at[k]);
		}
	// rounded, so that it rarely changes from frame to frame
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

void skin_track_warps(struct patch_warp *warp, const struct skin_track *t)
{
	for (int i = 0; i < t->points.n; i++)
		warp[i] = t->point[i].warp;
}

void skin_track_begin(struct skin_track *t, int m, const double (*at)[2], const struct patch_warp *warp)
{
	for (int i = 0; i < t->points.n && m > 0; i++) {
		const double *p = t->points.at[i];
		int near = 0;
		for (int k = 1; k < m; k++)
			near = hypot(at[k][0] - p[0], at[k][1] - p[1]) < hypot(at[near][0] - p[0], at[near][1] - p[1]) ? k : near;
		struct patch_warp *w = &t->point[i].warp;
		*w = warp[near];
		for (int r = 0; r < 2; r++)
			for (int c = 0; c < 2; c++)
				w->at[r] += w->A[r][c] * (p[c] - at[near][c]);
		t->point[i].before = *w;
	}
	t->has_last = false;
}

void skin_track_pack(struct pack *pack, struct skin_track *t)
{
	PACK(pack, t->has_last);
	PACK(pack, t->was_still);
	PACK(pack, t->gain);
	pack_bytes(pack, t->point, (size_t)t->points.n * sizeof *t->point);
	pack_bytes(pack, t->field, (size_t)t->points.n * sizeof *t->field);
	scales_pack(pack, &t->frame);
	scales_pack(pack, &t->last);
}

bool skin_track_was_still(const struct skin_track *t)
{
	return t->was_still;
}

double skin_track_push(struct skin_track *t, const uint8_t *luma, int stride, struct skin_point_state *state)
{
	struct scales swap = t->last;
	t->last = t->frame;
	t->frame = swap;
	fill(&t->frame, t, luma, stride);
	t->gain = skin_track_gain(t);
	t->was_still = skin_track_stands_still(t);
	if (t->was_still) {
		// the last frame worked on is kept for comparison, so that slow motion adds up until it is seen
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
