/* Pictures: every pixel's middle first, then more rays where neighbours differ. Tiles are independent of each other, so
 * that the bytes do not depend on the number of threads. */
#include "eye/scene_trace.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "math/vec.h"

enum { TILE = QUICK_TILE };
_Static_assert(TILE * TILE == BATCH, "a tile's first rays are one batch");

static void look_make(struct scene_look *look, const struct scene *s, const struct scene_view *view,
                      const struct scene_lighting *light, const struct scene_beams *beams)
{
	double t[3] = { view->cam_from_eye[0][3], view->cam_from_eye[1][3], view->cam_from_eye[2][3] };
	*look = (struct scene_look){ .light = light, .beams = beams, .textured = view->textured };
	for (int j = 0; j < 3; j++) {
		for (int i = 0; i < 3; i++) {
			look->origin[j] -= view->cam_from_eye[i][j] * t[i];
			look->cam_from_eye[i][j] = (float)view->cam_from_eye[i][j];
		}
	}
	for (int k = 0; k < 6; k++)
		look->slip[k / 3][k % 3] = (float)view->slip[k / 3][k % 3];
	double away = view->cam_from_eye[2][2] * s->eye.iris_depth + t[2];
	double mm = view->scale * away / view->camera.focal_px;
	look->level = scene_level_for(s, mm);
	look->soft = (float)(0.5 * mm);
}

struct canvas {
	const struct scene *scene;
	const struct scene_view *view;
	const struct scene_look *look;
	struct image *image;
	bool bent;  // the lens distorts
	struct sight_plane plane;
};

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

/* Rays through n points of the picture (px), traced. */
static void trace_points(float rgba[][4], int n, const float *x, const float *y, const struct canvas *c, long *iris)
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

/* A tile of a quick picture, n of whose rays are of the picture: by the rays at its nodes if these are enough. What its rays
 * met may be known from the picture before. out: rows `stride` floats apart. */
static void quick_tile(float *out, long stride, int n, int tx, int ty, int tile, const struct canvas *c, struct scene_count *count)
{
	struct quick_found mine, *kept = c->view->hits ? scene_hits_tile(c->view->hits, tile) : 0, *found = kept ? kept : &mine;
	if (!kept && !quick_grid(found, (float)tx + 0.5f, (float)ty + 0.5f, sight_rays_make, &c->plane, c->look->quick)) {
		float x[BATCH], y[BATCH];
		tile_points(x, y, tx, ty);
		quick_points(found, BATCH, x, y, c);
	}
	if (c->view->hits && !kept)
		scene_hits_keep(c->view->hits, tile, found);
	*(kept ? &count->kept : &count->rays) += n;
	count->iris += found->seen;
	if (found->kind != QUICK_MIXED) {
		quick_tile_colour(out, stride, found, c->look->quick);
		return;
	}
	float rgba[BATCH][4];
	quick_colour(rgba, found, BATCH, c->look->quick);
	for (int y = 0; y < TILE; y++)
		memcpy(out + y * stride, rgba[y * TILE], TILE * sizeof *rgba);
}

static bool any_visible(const struct scene_view *v, int tx, int ty, int x1, int y1)
{
	for (int y = ty; y < y1; y++)
		if (!v->visible || memchr(v->visible + (long)y * v->width + tx, 1, (size_t)(x1 - tx)))
			return true;
	return false;
}

static void first_rays(const struct canvas *c, int tile, int tx, int ty, struct scene_count *count)
{
	float rgba[BATCH][4];
	int x1 = tx + TILE < c->view->width ? tx + TILE : c->view->width, y1 = ty + TILE < c->view->height ? ty + TILE : c->view->height;
	int n = (x1 - tx) * (y1 - ty);
	bool whole = n == BATCH;
	if (!any_visible(c->view, tx, ty, x1, y1)) {
		count->hidden += n;
		for (int y = ty; y < y1; y++)
			memset(image_at(c->image, tx, y), 0, (size_t)(x1 - tx) * sizeof *rgba);
		return;
	}
	if (c->look->quick && whole) {
		quick_tile(image_at(c->image, tx, ty), 4L * c->image->width, n, tx, ty, tile, c, count);
		return;
	}
	if (c->look->quick) {
		quick_tile(rgba[0], 4 * TILE, n, tx, ty, tile, c, count);
	} else {
		float x[BATCH], y[BATCH];
		tile_points(x, y, tx, ty);
		trace_points(rgba, BATCH, x, y, c, &count->iris);
		count->rays += n;
	}
	for (int y = ty; y < y1; y++)
		memcpy(image_at(c->image, tx, y), rgba[(y - ty) * TILE], (size_t)(x1 - tx) * sizeof *rgba);
}

/* About what the eye makes of a value: steps of it, not of light, decide where more rays go. */
static float seen(const float *p, int c)
{
	return sqrtf(p[c] > 0 ? p[c] < 1.2f ? p[c] : 1.2f : 0);
}

/* A pixel whose neighbours differ from it by more than 4 % of white. */
static bool is_edge(const struct image *image, int x, int y)
{
	static const int step[4][2] = { { -1, 0 }, { 1, 0 }, { 0, -1 }, { 0, 1 } };
	const float *p = image_at(image, x, y);
	for (int k = 0; k < 4; k++) {
		int u = x + step[k][0], v = y + step[k][1];
		if (u < 0 || v < 0 || u >= image->width || v >= image->height)
			continue;
		const float *q = image_at(image, u, v);
		for (int c = 0; c < 3; c++)
			if (fabsf(seen(p, c) - seen(q, c)) > 0.04f)
				return true;
		if (p[3] != q[3])
			return true;
	}
	return false;
}

struct refine {
	float x[BATCH], y[BATCH];
	int pixel[BATCH], n;
	float sum[BATCH][4];  // by pixel of the tile
};

static void refine_flush(struct refine *r, const struct canvas *c, struct scene_count *count)
{
	float rgba[BATCH][4];
	if (!r->n)
		return;
	trace_points(rgba, r->n, r->x, r->y, c, &count->iris);
	for (int i = 0; i < r->n; i++)
		for (int k = 0; k < 4; k++)  // a mirror image brighter than white counts as a little more than white
			r->sum[r->pixel[i]][k] += rgba[i][k] < 2 ? rgba[i][k] : 2;
	count->rays += r->n;
	r->n = 0;
}

/* samples^2 rays in the marked pixels of a tile, in place of the first one. */
static void more_rays(const struct canvas *c, const unsigned char *mark, int tx, int ty, struct scene_count *count)
{
	struct refine r = { .n = 0 };
	int m = c->view->samples, w = c->view->width, h = c->view->height;
	for (int k = 0; k < BATCH; k++) {
		int x = tx + k % TILE, y = ty + k / TILE;
		for (int j = 0; x < w && y < h && mark[(long)y * w + x] && j < m * m; j++) {
			r.x[r.n] = (float)x + ((float)(j % m) + 0.5f) / (float)m;
			r.y[r.n] = (float)y + ((float)(j / m) + 0.5f) / (float)m;
			r.pixel[r.n] = k;
			if (++r.n == BATCH)
				refine_flush(&r, c, count);
		}
	}
	refine_flush(&r, c, count);
	for (int k = 0; k < BATCH; k++) {
		int x = tx + k % TILE, y = ty + k / TILE;
		for (int i = 0; x < w && y < h && mark[(long)y * w + x] && i < 4; i++)
			image_at(c->image, x, y)[i] = r.sum[k][i] / (float)(m * m);
	}
}

struct image scene_render(const struct scene *s, const struct scene_view *view, const struct scene_lighting *light,
                          struct scene_count *count)
{
	if (view->visible && !memchr(view->visible, 1, (size_t)view->width * (size_t)view->height)) {  // the lids are closed
		if (count)
			count->hidden += (long)view->width * view->height;
		return image_new(view->width, view->height, 4);
	}
	double eye_from_cam[3][3];
	for (int k = 0; k < 9; k++)
		eye_from_cam[k / 3][k % 3] = view->cam_from_eye[k % 3][k / 3];
	struct scene_beams beams = scene_beams(s, light, eye_from_cam);
	struct scene_look look;
	look_make(&look, s, view, light, &beams);
	struct image image = { view->width, view->height, 4, mem_array(4 * (size_t)view->width * (size_t)view->height, sizeof(float)) };
	struct canvas c = { s, view, &look, &image, false, sight_plane(&look, view, s->sclera_z) };
	for (int i = 0; i < 5; i++)
		c.bent = c.bent || view->camera.distortion[i] != 0;
	int across = (view->width + TILE - 1) / TILE, tiles = across * ((view->height + TILE - 1) / TILE);
	long rays = 0, iris = 0, kept = 0, hidden = 0;
	struct scene_shade shade = { 0 };
	struct quick_look quick;
	if (s->conf.shading == SCENE_TEXELS && !c.bent) {
		shade = scene_shade_make(s, look.level, look.origin, view->textured, &beams);
		quick = quick_look(s, view, light, &shade, look.level);
		look.quick = &quick;
		if (view->hits)
			scene_hits_for(view->hits, s, view, tiles);
	}
	unsigned char *mark = view->samples > 1 ? mem_new((size_t)view->width * (size_t)view->height, 1) : 0;
#pragma omp parallel reduction(+ : rays, iris, kept, hidden)
	{
		struct scene_count mine = { 0 };
#pragma omp for schedule(dynamic, 40)
		for (int i = 0; i < tiles; i++)
			first_rays(&c, i, i % across * TILE, i / across * TILE, &mine);
#pragma omp for schedule(static)
		for (int y = 0; y < (mark ? view->height : 0); y++)
			for (int x = 0; x < view->width; x++)
				mark[(long)y * view->width + x] = (!view->visible || view->visible[(long)y * view->width + x]) && is_edge(&image, x, y);
#pragma omp for schedule(dynamic, 4)
		for (int i = 0; i < (mark ? tiles : 0); i++)
			more_rays(&c, mark, i % across * TILE, i / across * TILE, &mine);
		rays += mine.rays;
		iris += mine.iris;
		kept += mine.kept;
		hidden += mine.hidden;
	}
	free(mark);
	free(shade.light);
	free(beams.beam);
	if (count)
		*count = (struct scene_count){ count->rays + rays, count->iris + iris, count->kept + kept, count->hidden + hidden };
	return image;
}
