/* A picture: a ray through the middle of every pixel first, then more rays where neighbours differ. Tiles are independent of each
 * other, so that the bytes do not depend on the number of threads. */
#include "draw/eye/render.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "draw/eye/exact/canvas.h"
#include "draw/eye/levels.h"
#include "draw/eye/march/shade.h"
#include "draw/eye/quick/hits.h"

enum { RUN = 40 };  // tiles in a row that one thread takes at a time

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

/* Approximate perceived brightness: steps of it, not of light, decide where more rays are traced. */
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
	canvas_trace(rgba, r->n, r->x, r->y, c, &count->iris);
	for (int i = 0; i < r->n; i++)
		for (int k = 0; k < 4; k++)  // clamps reflections brighter than white, so that one sample does not dominate its pixel
			r->sum[r->pixel[i]][k] += rgba[i][k] < 2 ? rgba[i][k] : 2;
	count->rays += r->n;
	r->n = 0;
}

/* Traces samples^2 rays in the marked pixels of a tile, in place of the first one. */
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
	struct scene_look look;
	struct scene_beams beams = { 0 };
	look_make(&look, s, view, light, &beams);
	struct image image = { view->width, view->height, 4, mem_array(4 * (size_t)view->width * (size_t)view->height, sizeof(float)) };
	struct canvas c = { s, view, &look, &image, false, sight_plane(&look, view, s->sclera_z) };
	for (int i = 0; i < 5; i++)
		c.bent = c.bent || view->camera.distortion[i] != 0;
	int across = (view->width + TILE - 1) / TILE, tiles = across * ((view->height + TILE - 1) / TILE);
	long rays = 0, iris = 0, kept = 0, hidden = 0;
	struct scene_shade shade = { 0 };
	struct quick_look quick;
	bool texels = s->conf.shading == SCENE_TEXELS && !c.bent && (!view->textured || s->paths);
	if (!texels || !view->textured)
		beams = scene_beams(s, light, eye_from_cam);
	if (texels) {
		shade = view->textured ? scene_shade_flat(s, look.level, light, eye_from_cam) : scene_shade_make(s, look.level, look.origin, &beams);
		quick = quick_look(s, view, light, &shade, look.level);
		look.quick = &quick;
		if (view->hits)
			scene_hits_for(view->hits, s, view, tiles);
	}
	unsigned char *mark = view->samples > 1 ? mem_new((size_t)view->width * (size_t)view->height, 1) : 0;
#pragma omp parallel reduction(+ : rays, iris, kept, hidden)
	{
		struct scene_count mine = { 0 };
#pragma omp for schedule(dynamic)
		for (int i = 0; i < tiles; i += RUN)
			canvas_first(&c, i, i + RUN < tiles ? i + RUN : tiles, across, &mine);
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
	scene_beams_free(&beams);
	if (count)
		*count = (struct scene_count){ count->rays + rays, count->iris + iris, count->kept + kept, count->hidden + hidden };
	return image;
}
