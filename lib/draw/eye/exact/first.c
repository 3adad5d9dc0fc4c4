/* The first rays of a picture: through the middle of every pixel, tile by tile. */
#include <string.h>

#include "draw/eye/exact/canvas.h"
#include "draw/eye/quick/hits.h"
#include "math/vec.h"

static void quick_points(struct quick_found *found, int n, const float *x, const float *y, const struct canvas *c)
{
	struct quick_rays r = { .n = n };
	sight_rays_make(&r, x, y, &c->plane);
	quick_find(found, &r, c->look->quick);
}

/* Middles of a tile's pixels. */
static void tile_points(float *x, float *y, int tx, int ty)
{
	for (int i = 0; i < BATCH; i++) {
		x[i] = (float)(tx + i % TILE) + 0.5f;
		y[i] = (float)(ty + i / TILE) + 0.5f;
	}
}

void canvas_trace(float rgba[][4], int n, const float *x, const float *y, const struct canvas *c, long *iris)
{
	float dx[BATCH], dy[BATCH], dz[BATCH];
	const struct scene_view *v = c->view;
	if (c->look->quick && !c->bent) {
		struct quick_found found;
		quick_points(&found, n, x, y, c);
		quick_colour(rgba, &found, n, c->look->quick);
		*iris += found.seen;
		return;
	}
	for (int i = 0; i < n; i++) {
		double px[2] = { v->x0 + v->scale * x[i], v->y0 + v->scale * y[i] }, cam[3], d[3];
		if (c->bent) {
			camera_ray(cam, &v->camera, px);
		} else {
			cam[0] = (px[0] - v->camera.center_px[0]) / v->camera.focal_px;
			cam[1] = (px[1] - v->camera.center_px[1]) / v->camera.focal_px;
			cam[2] = 1;
		}
		for (int j = 0; j < 3; j++)
			d[j] = v->cam_from_eye[0][j] * cam[0] + v->cam_from_eye[1][j] * cam[1] + v->cam_from_eye[2][j] * cam[2];
		vec_unit(d, d);
		dx[i] = (float)d[0];
		dy[i] = (float)d[1];
		dz[i] = (float)d[2];
	}
	scene_trace(rgba, n, dx, dy, dz, c->scene, c->look, iris);
}

/* A tile of the picture. Of a quick one also what its rays met: found now (mine), or kept from the picture before. */
struct tile {
	int at, x, y, x1, y1;  // number of the tile; its first pixel; end of its part inside the picture
	bool hidden, kept;
	struct quick_found mine, *found;
};

static bool any_visible(const struct scene_view *v, const struct tile *t)
{
	for (int y = t->y; y < t->y1; y++)
		if (!v->visible || memchr(v->visible + (long)y * v->width + t->x, 1, (size_t)(t->x1 - t->x)))
			return true;
	return false;
}

/* Sets the tile's place; returns whether its rays have yet to be followed. */
static bool tile_place(struct tile *t, int at, int across, const struct canvas *c)
{
	const struct scene_view *v = c->view;
	t->at = at;
	t->x = at % across * TILE;
	t->y = at / across * TILE;
	t->x1 = t->x + TILE < v->width ? t->x + TILE : v->width;
	t->y1 = t->y + TILE < v->height ? t->y + TILE : v->height;
	t->hidden = !any_visible(v, t);
	t->found = !t->hidden && v->hits && c->look->quick ? scene_hits_tile(v->hits, at) : 0;
	t->kept = t->found;
	return !t->hidden && !t->kept;
}

/* Consecutive tiles of a row, first..end - 1, that have yet to be found, and the rays followed at their nodes. */
struct strip {
	int first, end;
	struct quick_strip nodes;
};

static void strip_begin(struct strip *s, int first, int most, int across, const struct canvas *c)
{
	struct tile t;
	int row = (first / across + 1) * across;
	s->first = first;
	most = most < row ? most : row;
	most = most < first + STRIP_TILES ? most : first + STRIP_TILES;
	for (s->end = first + 1; s->end < most && tile_place(&t, s->end, across, c); s->end++)
		;
	quick_strip(&s->nodes, (float)(first % across * TILE) + 0.5f, (float)(first / across * TILE) + 0.5f, s->end - first, sight_rays_make, &c->plane, c->look->quick);
}

/* Finds a tile of a quick picture: by the rays at its nodes if these are enough, else by every ray. most: end of this thread's
 * tiles. */
static void tile_begin(struct tile *t, struct strip *strip, int at, int most, int across, const struct canvas *c)
{
	bool find = tile_place(t, at, across, c);
	if (t->hidden || !c->look->quick)
		return;
	if (find) {
		t->found = &t->mine;
		if (at >= strip->end)
			strip_begin(strip, at, most, across, c);
		if (!quick_grid(t->found, &strip->nodes, at - strip->first, c->look->quick)) {
			float x[BATCH], y[BATCH];
			tile_points(x, y, t->x, t->y);
			quick_points(t->found, BATCH, x, y, c);
		}
	}
	quick_ask(t->found, c->look->quick);
}

/* out: rows `stride` floats apart. */
static void quick_tile(float *out, long stride, struct tile *t, const struct canvas *c)
{
	struct quick_found *found = t->found;
	if (!t->kept)
		quick_grid_pixels(found, c->look->quick);
	if (c->view->hits && !t->kept)
		scene_hits_keep(c->view->hits, t->at, found);
	if (found->kind != QUICK_MIXED) {
		quick_tile_colour(out, stride, found, c->look->quick);
		return;
	}
	float rgba[BATCH][4];
	quick_colour(rgba, found, BATCH, c->look->quick);
	for (int y = 0; y < TILE; y++)
		memcpy(out + y * stride, rgba[y * TILE], TILE * sizeof *rgba);
}

static void tile_end(struct tile *t, const struct canvas *c, struct scene_count *count)
{
	float rgba[BATCH][4];
	int n = (t->x1 - t->x) * (t->y1 - t->y);
	if (t->hidden) {
		count->hidden += n;
		for (int y = t->y; y < t->y1; y++)
			memset(image_at(c->image, t->x, y), 0, (size_t)(t->x1 - t->x) * sizeof *rgba);
		return;
	}
	*(c->look->quick && t->kept ? &count->kept : &count->rays) += n;
	if (c->look->quick) {
		bool whole = n == BATCH;
		quick_tile(whole ? image_at(c->image, t->x, t->y) : rgba[0], whole ? 4L * c->image->width : 4 * TILE, t, c);
		count->iris += t->found->seen;
		if (whole)
			return;
	} else {
		float x[BATCH], y[BATCH];
		tile_points(x, y, t->x, t->y);
		canvas_trace(rgba, BATCH, x, y, c, &count->iris);
	}
	for (int y = t->y; y < t->y1; y++)
		memcpy(image_at(c->image, t->x, y), rgba[(y - t->y) * TILE], (size_t)(t->x1 - t->x) * sizeof *rgba);
}

/* While one tile is coloured, the memory that the next one reads is being prefetched. */
void canvas_first(const struct canvas *c, int from, int to, int across, struct scene_count *count)
{
	struct tile tile[2];
	struct strip strip = { .end = from };
	for (int i = from; i <= to; i++) {
		if (i < to)
			tile_begin(&tile[i % 2], &strip, i, to, across, c);
		if (i > from)
			tile_end(&tile[(i - 1) % 2], c, count);
	}
}
