#include "track/clip/folds.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "image/mask.h"
#include "track/clip/scale.h"

static const double margin_px = 24;
static const size_t room_bytes = 200 << 20;  // for the frames that are kept

struct folds {
	int x0, y0, width, height;     // part of the picture that is kept
	int per;                       // frames of an expression, at most
	int n;
	long *frame;                   // [n] rising
	uint8_t **grey;                // [n][height][width]
};

/* Frame k of those between neutral and peak of an expression. */
static long frame_of(const struct opt_each *e, int k, int n)
{
	return lround(e->value[0] + (e->value[1] - e->value[0]) * k / (n - 1));
}

static int frames_of(const struct opt_each *e, int per)
{
	return (int)fmin(per, fabs(e->value[1] - e->value[0]) + 1);
}

static int by_frame(const void *a, const void *b)
{
	long x = *(const long *)a, y = *(const long *)b;
	return (x > y) - (x < y);
}

struct folds *folds_new(const struct track_clip *clip, const struct track_points *points, const struct track_conf *conf)
{
	const struct opt_each_list *list = &conf->expression;
	if (!points->n || !list->n)
		return 0;
	struct folds *f = mem_new(1, sizeof *f);
	double low[2] = { INFINITY, INFINITY }, high[2] = { 0, 0 };
	for (int i = 0; i < points->n; i++)
		for (int k = 0; k < 2; k++) {
			low[k] = fmin(low[k], points->points.at[i][k]);
			high[k] = fmax(high[k], points->points.at[i][k]);
		}
	f->x0 = (int)fmax(0, low[0] - margin_px);
	f->y0 = (int)fmax(0, low[1] - margin_px);
	f->width = (int)fmin(clip->info.width, high[0] + margin_px) - f->x0;
	f->height = (int)fmin(clip->info.height, high[1] + margin_px) - f->y0;
	double fit = (double)room_bytes / ((double)f->width * f->height * list->n);
	f->per = (int)fmax(2, fmin(conf->wrinkle.frames, fit));
	f->frame = mem_new((size_t)f->per * (size_t)list->n, sizeof *f->frame);
	int all = 0;
	for (int e = 0; e < list->n; e++)
		for (int k = 0, n = frames_of(&list->items[e], f->per); k < n && n > 1; k++)
			f->frame[all++] = frame_of(&list->items[e], k, n);
	qsort(f->frame, (size_t)all, sizeof *f->frame, by_frame);
	for (int i = 0; i < all; i++)
		if (!f->n || f->frame[i] != f->frame[f->n - 1])
			f->frame[f->n++] = f->frame[i];
	f->grey = mem_new((size_t)f->n + 1, sizeof *f->grey);
	return f;
}

static int kept(const struct folds *f, long frame)
{
	const long *at = bsearch(&frame, f->frame, (size_t)f->n, sizeof *f->frame, by_frame);
	return at ? (int)(at - f->frame) : -1;
}

/* Green: haemoglobin absorbs it most, which shows a face's relief, and a camera measures it best. */
void folds_add(struct folds *f, const struct video_frame *frame)
{
	int at = f ? kept(f, frame->index) : -1;
	if (at < 0 || f->grey[at])
		return;
	size_t area = (size_t)frame->width * (size_t)frame->height;
	uint8_t *rgb = mem_array(3 * area, 1), *to = f->grey[at] = mem_array((size_t)f->width * (size_t)f->height, 1);
	video_frame_rgb(rgb, 3 * frame->width, frame, f->x0, f->y0, f->x0 + f->width, f->y0 + f->height);
	for (int y = 0; y < f->height; y++)
		for (int x = 0; x < f->width; x++)
			to[(long)y * f->width + x] = rgb[3 * ((long)(y + f->y0) * frame->width + x + f->x0) + 1];
	free(rgb);
}

void folds_pack(struct pack *pack, struct folds *f, long first)
{
	const size_t area = f ? (size_t)f->width * (size_t)f->height : 0;
	for (int i = 0; f && i < f->n; i++) {
		bool here = f->grey[i] && f->frame[i] >= first;
		PACK(pack, here);
		if (pack->reading && here && !f->grey[i])
			f->grey[i] = mem_array(area, 1);
		if (here)
			pack_bytes(pack, f->grey[i], area);
	}
}

void folds_free(struct folds *f)
{
	if (!f)
		return;
	for (int i = 0; i < f->n; i++)
		free(f->grey[i]);
	free(f->grey);
	free(f->frame);
	free(f);
}

static struct wrinkle_frame seen(const struct folds *f, const struct track_result *r, long frame)
{
	int at = kept(f, frame);
	return (struct wrinkle_frame){ frame, at < 0 ? 0 : f->grey[at], (const float(*)[2])r->skin + frame * r->n_points,
		                           r->confidence + frame * r->n_points };
}

/* Mask of the chart's skin, without the openings of the eyes and what lashes cover. */
static uint8_t *skin_of(const struct folds *f, const struct track_clip *clip, const struct track_points *points, double lash_px)
{
	uint8_t *mask = mem_array((size_t)f->width * (size_t)f->height, 1);
	for (int y = 0; y < f->height; y++)
		memcpy(mask + (long)y * f->width, points->mask + (long)(y + f->y0) * clip->info.width + f->x0, (size_t)f->width);
	mask_grow(mask, f->width, f->height, -lash_px);
	return mask;
}

static bool one(struct wrinkles *w, struct wrinkle_frame ends[2], const struct folds *f, const struct track_result *r,
                const struct opt_each *e, const struct wrinkle_ground *ground, const struct wrinkle_conf *conf, struct stage *stage, struct err *err)
{
	int n = frames_of(e, f->per), all = 0;
	struct wrinkle_frame *frames = mem_new((size_t)n + 1, sizeof *frames);
	bool lost = false;
	for (int k = 0; k < n && n > 1; k++) {
		long at = frame_of(e, k, n);
		bool gone = r->lost_at[at];
		lost = lost || (gone && (k == 0 || k == n - 1));
		if (!gone)
			frames[all++] = seen(f, r, at);
	}
	if (n < 2)
		stage_skipped(stage, "wrinkles of expression.%s = %s: neutral and peak are one frame", e->name, e->text);
	else if (lost)
		stage_skipped(stage, "wrinkles of expression.%s = %s: the face is not seen in its neutral or its peak frame", e->name, e->text);
	ends[0] = frames[0];
	ends[1] = frames[all > 0 ? all - 1 : 0];
	bool ok = wrinkle_find(w, e->name, n < 2 || lost ? 0 : all, frames, ground, conf, err);
	free(frames);
	return ok;
}

bool folds_find(struct folds_found *found, const struct folds *f, struct stage *stage, const struct track_result *r, const struct track_clip *clip,
                const struct track_subject *s, const struct track_points *points, const struct track_conf *conf, struct err *err)
{
	const struct opt_each_list *list = &conf->expression;
	double px_per_mm = track_px_per_mm(clip, clip->cam_from_head, s);
	*found = (struct folds_found){ .mask = skin_of(f, clip, points, conf->wrinkle.lash_mm * px_per_mm), .normals = mesh_normals(&s->mesh) };
	found->rays = ray_scene_new(s->mesh.n_vertices, (const float(*)[3])s->mesh.vertices, s->mesh.n_faces, (const int32_t(*)[3])s->mesh.faces);
	found->ground = (struct wrinkle_ground){ f->x0, f->y0, f->width, f->height, px_per_mm, points->n, (const double(*)[2])points->points.at, found->mask,
		                                     &s->mesh, (const float(*)[3])found->normals, found->rays, &clip->camera, clip->cam_from_head };
	found->neutral = mem_new((size_t)list->n, sizeof *found->neutral);
	found->peak = mem_new((size_t)list->n, sizeof *found->peak);
	bool ok = true;
	for (int e = 0; e < list->n && ok; e++) {
		struct wrinkle_frame ends[2];
		ok = one(&found->wrinkles, ends, f, r, &list->items[e], &found->ground, &conf->wrinkle, stage, err);
		found->neutral[e] = ends[0];
		found->peak[e] = ends[1];
	}
	return ok;
}

void folds_found_free(struct folds_found *found)
{
	free(found->neutral);
	free(found->peak);
	free(found->mask);
	free(found->normals);
	ray_scene_free(found->rays);
	wrinkles_free(&found->wrinkles);
}
