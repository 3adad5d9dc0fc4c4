#include "track/clip/folds.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "image/exr.h"
#include "image/mask.h"

static const double margin_px = 24;
static const size_t room_bytes = 200 << 20;  // for the frames that are kept

const char *const wrinkle_files[WRINKLE_FILES] = { "work/skin/wrinkles.json", "work/skin/wrinkles.exr", "work/skin/wrinkles.png" };

struct folds {
	int x0, y0, width, height;     // part of the picture that is kept
	int per;                       // frames of an expression, at most
	int n;
	long *frame;                   // [n] rising
	uint8_t **grey;                // [n][height][width]
};

bool wrinkles_wanted(const struct track_conf *conf, bool has_mesh)
{
	return conf->expression.n && has_mesh;
}

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

/* Green: the colour in which blood makes most of a face's relief, and the one a camera measures best. */
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

/* The chart's skin: not the openings of the eyes, nor what lashes stand before. */
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

static bool save_bumps(struct stage *stage, const struct wrinkles *w, int n, const char *const in[], struct err *err)
{
	struct image all = image_new(w->width, w->height, 2 * w->n);
	char **name = mem_new(2 * (size_t)w->n + 1, sizeof *name);
	for (int i = 0; i < w->n; i++) {
		struct image one = wrinkle_bump(w, &w->pose[i]);
		for (long k = 0; k < (long)w->width * w->height; k++)
			memcpy(all.px + 2 * (k * w->n + i), one.px + 2 * k, 2 * sizeof *one.px);
		name[2 * i] = mem_printf("%s.height", w->pose[i].name);
		name[2 * i + 1] = mem_printf("%s.open", w->pose[i].name);
		image_free(&one);
	}
	struct exr_info info = { .made_by = stage_made_by(stage, n, in) };
	bool ok = exr_write(stage_path(stage, "%s", wrinkle_files[1]), &all, (const char *const *)name, EXR_HALF, &info, err);
	for (int i = 0; i < 2 * w->n; i++)
		free(name[i]);
	free(name);
	image_free(&all);
	return ok;
}

static void tell(struct stage *stage, const struct wrinkles *w)
{
	int lines = 0;
	double deepest = 0;
	for (int i = 0; i < w->n; i++) {
		const struct wrinkle_pose *p = &w->pose[i];
		double most = 0, length = 0;
		for (int k = 0; k < p->n; k++) {
			length += p->line[k].length;
			for (int j = 0; j < p->line[k].n; j++)
				most = fmax(most, p->line[k].point[j].depth);
		}
		lines += p->n;
		deepest = fmax(deepest, most);
		if (p->n)
			stage_note(stage, "expression.%s: %d wrinkle lines, %.0f mm in all, up to %.2f mm deep", p->name, p->n, length, most);
		else if (p->n_frames)
			stage_note(stage, "expression.%s: the skin folds into no line that its neutral frame does not have", p->name);
	}
	stage_figure(stage, "wrinkle_lines", lines, "");
	stage_figure(stage, "wrinkle_deepest", deepest, "mm");
}

bool folds_finish(struct folds *f, struct stage *stage, const struct track_result *r, const struct track_clip *clip,
                  const struct track_subject *s, const struct track_points *points, const struct track_conf *conf, int n,
                  const char *const in[], struct err *err)
{
	const struct opt_each_list *list = &conf->expression;
	if (!f) {
		stage_skipped(stage, "wrinkles: %s", list->n ? "no mesh of the person to find their depth on" : "capture.conf marks no expression: set expression.NAME to its neutral and peak frame");
		for (int i = 0; i < WRINKLE_FILES; i++)
			if (file_exists(stage_path(stage, "%s", wrinkle_files[i])) && !file_remove(stage_path(stage, "%s", wrinkle_files[i]), err))
				return false;
		return true;
	}
	double px_per_mm = clip->camera.focal_px / clip->cam_from_head[2][3];
	uint8_t *mask = skin_of(f, clip, points, conf->wrinkle.lash_mm * px_per_mm);
	struct ray_scene *rays = ray_scene_new(s->mesh.n_vertices, (const float(*)[3])s->mesh.vertices, s->mesh.n_faces, (const int32_t(*)[3])s->mesh.faces);
	float (*normals)[3] = mesh_normals(&s->mesh);
	struct wrinkle_ground ground = { f->x0, f->y0, f->width, f->height, px_per_mm, points->n, (const double(*)[2])points->points.at, mask,
		                             &s->mesh, (const float(*)[3])normals, rays, &clip->camera, clip->cam_from_head };
	struct wrinkles w = { 0 };
	struct wrinkle_frame *neutral = mem_new((size_t)list->n, sizeof *neutral), *peak = mem_new((size_t)list->n, sizeof *peak);
	bool ok = true;
	for (int e = 0; e < list->n && ok; e++) {
		struct wrinkle_frame ends[2];
		ok = one(&w, ends, f, r, &list->items[e], &ground, &conf->wrinkle, stage, err);
		neutral[e] = ends[0];
		peak[e] = ends[1];
	}
	ok = ok && wrinkles_save(&w, stage_path(stage, "%s", wrinkle_files[0]), stage_made_by(stage, n, in), err)
	     && save_bumps(stage, &w, n, in, err)
	     && wrinkle_sheet(stage_path(stage, "%s", wrinkle_files[2]), &w, &ground, list->n, neutral, peak, err);
	for (int i = 0; i < WRINKLE_FILES && ok; i++)
		ok = stage_made(stage, wrinkle_files[i], n, in, err);
	if (ok)
		tell(stage, &w);
	free(neutral);
	free(peak);
	free(mask);
	free(normals);
	ray_scene_free(rays);
	wrinkles_free(&w);
	return ok;
}
