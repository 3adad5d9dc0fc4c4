/* Pictures side by side: the turntable strip, and the contact sheet of everything that was rendered. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "bridge/cv_draw.h"
#include "bridge/cv_photo.h"
#include "render/render.h"

enum { MARGIN = 14, CAPTION = 26 };
static const uint8_t ground[3] = { 24, 24, 26 }, ink[3] = { 205, 205, 200 };

struct image sheet_strip(int n, const struct image frames[])
{
	int w = frames[0].width, h = frames[0].height;
	struct image out = image_new(n * w, h, 3);
	for (int i = 0; i < n; i++)
		for (int y = 0; y < h; y++)
			memcpy(image_at(&out, i * w, y), image_at(&frames[i], 0, y), (size_t)w * 3 * sizeof(float));
	return out;
}

/* Reads a picture and reduces it to `width` px; null when it cannot be read, which is no error. */
static uint8_t *thumbnail(int *height, const char *path, int width)
{
	struct err err = { 0 };
	uint8_t *px, *small;
	int w, h;
	if (!file_exists(path) || !picture_read(&px, &w, &h, path, 200, &err))
		return 0;
	*height = (int)fmax(lrint((double)h * width / w), 1);
	small = cv_resize8(px, w, h, 3, width, *height);
	free(px);
	return small;
}

struct sheet {
	struct cv_picture picture;
	int y;  // first free row
};

static void sheet_grow(struct sheet *s, int rows)
{
	struct cv_picture *p = &s->picture;
	if (s->y + rows <= p->height)
		return;
	int old = p->height;
	p->height = s->y + rows;
	p->px = mem_grow(p->px, (size_t)p->width * (size_t)p->height * 3, 1);
	for (long i = (long)old * p->width; i < (long)p->height * p->width; i++)
		memcpy(p->px + 3 * i, ground, 3);
}

/* One row of pictures of equal width with captions below; those that are missing are left out. */
static void sheet_row(struct sheet *s, int n, const char *const paths[], const char *const captions[])
{
	enum { MOST = 2 };
	int tallest = 0, width = (s->picture.width - (n + 1) * MARGIN) / n, at = MARGIN, height[MOST];
	uint8_t *small[MOST];
#pragma omp parallel for
	for (int i = 0; i < n; i++)
		small[i] = thumbnail(&height[i], paths[i], width);
	for (int i = 0; i < n; i++) {
		int h = height[i];
		uint8_t *px = small[i];
		if (!px)
			continue;
		sheet_grow(s, h + CAPTION + MARGIN);
		for (int y = 0; y < h; y++)
			memcpy(s->picture.px + 3 * ((long)(s->y + y) * s->picture.width + at), px + 3L * y * width, (size_t)width * 3);
		cv_draw_text(&s->picture, at + 1, s->y + h + 18, 10, captions[i], ink);
		tallest = h > tallest ? h : tallest;
		at += width + MARGIN;
		free(px);
	}
	s->y += tallest ? tallest + CAPTION + MARGIN : 0;
}

bool sheet_contact(struct job *job, struct err *err)
{
	const char *dir = job->names->render;
	const char *rel = stage_path(job->stage, "%s/contact_sheet.png", dir) + strlen(job->stage->capture) + 1;
	const char **in = mem_new((size_t)job->n_shots + 3, sizeof *in);
	int n = 0;
	for (int i = 0; i < job->n_shots; i++)
		in[n++] = stage_path(job->stage, "%s/%s_compare.png", dir, job->shots[i].photo->name);
	in[n++] = stage_path(job->stage, "%s/front.png", dir);
	in[n++] = stage_path(job->stage, "%s/three_quarter.png", dir);
	in[n++] = stage_path(job->stage, "%s/turntable.png", dir);
	const char **rels = mem_new((size_t)n, sizeof *rels);
	for (int i = 0; i < n; i++)
		rels[i] = in[i] + strlen(job->stage->capture) + 1;
	bool ok = stage_fresh(job->stage, rel, n, rels);
	if (!ok) {
		struct sheet s = { .picture = { .width = job->conf->sheet_px, .channels = 3 }, .y = MARGIN };
		sheet_grow(&s, 0);
		for (int i = 0; i < job->n_shots; i++) {
			char *caption = mem_printf("%s: photograph, rendering, difference x 4", job->shots[i].photo->name);
			sheet_row(&s, 1, &in[i], (const char *const[]){ caption });
			free(caption);
		}
		sheet_row(&s, 2, &in[n - 3], (const char *const[]){ "front", "three-quarter" });
		sheet_row(&s, 1, &in[n - 1], (const char *const[]){ "turntable" });
		ok = picture_png_write(stage_path(job->stage, "%s", rel), s.picture.px, s.picture.width, s.picture.height, 3, err)
		     && stage_made(job->stage, rel, n, rels, err);
		free(s.picture.px);
	}
	free(in);
	free(rels);
	return ok;
}
