/* Rays through the middles of a picture's pixels, tile by tile. */
#include <string.h>

#include "eye/scene_canvas.h"
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

/* A tile of the picture; of a quick one, what its rays met, found now or known from the picture before. */
struct tile {
	int at, x, y, x1, y1;  // pixels to x1, y1 are the picture's
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

/* Of a quick picture: by the rays at the tile's nodes if these are enough. */
static void tile_begin(struct tile *t, int at, int across, const struct canvas *c)
{
	const struct scene_view *v = c->view;
	int tx = at % across * TILE, ty = at / across * TILE;
	t->at = at;
	t->x = tx;
	t->y = ty;
	t->x1 = tx + TILE < v->width ? tx + TILE : v->width;
	t->y1 = ty + TILE < v->height ? ty + TILE : v->height;
	t->hidden = !any_visible(v, t);
	if (t->hidden || !c->look->quick)
		return;
	t->found = v->hits ? scene_hits_tile(v->hits, at) : 0;
	t->kept = t->found;
	if (!t->kept) {
		t->found = &t->mine;
		if (!quick_grid(t->found, (float)tx + 0.5f, (float)ty + 0.5f, sight_rays_make, &c->plane, c->look->quick)) {
			float x[BATCH], y[BATCH];
			tile_points(x, y, tx, ty);
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

/* What the next tile reads of the maps is under way while one is coloured. */
void canvas_first(const struct canvas *c, int from, int to, int across, struct scene_count *count)
{
	struct tile tile[2];
	for (int i = from; i <= to; i++) {
		if (i < to)
			tile_begin(&tile[i % 2], i, across, c);
		if (i > from)
			tile_end(&tile[(i - 1) % 2], c, count);
	}
}
