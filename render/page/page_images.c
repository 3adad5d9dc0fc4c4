#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "base/mem.h"
#include "bridge/cv_blur.h"
#include "bridge/cv_photo.h"
#include "draw/web/picture.h"
#include "draw/web/pseudocolour.h"
#include "image/exr.h"
#include "image/picture.h"
#include "render/page/page.h"

static json_t *pixels_at_most(const uint8_t *px, int w, int h, int width)
{
	if (w <= width)
		return web_picture(px, w, h);
	int height = (int)fmax(lrint((double)h * width / w), 1);
	uint8_t *small = cv_resize8(px, w, h, 3, width, height);
	json_t *picture = web_picture(small, width, height);
	free(small);
	return picture;
}

/* A file of the folder as the review page, in work/review/, links it: escaped as an address, byte by byte. Null for kinds that browsers do not
 * show. */
static json_t *link_of(struct page *page, const char *path)
{
	static const char *const shown[] = { ".png", ".jpg", ".jpeg", ".webp", ".avif", ".svg" }, work[] = "work/";
	const char *rel = path + strlen(page->stage->capture) + 1, *dot = strrchr(rel, '.');
	int kind = 0;
	while (kind < COUNT(shown) && !(dot && !strcasecmp(dot, shown[kind])))
		kind++;
	if (kind == COUNT(shown))
		return 0;
	const bool made = !strncmp(rel, work, strlen(work));
	char *out = mem_new(3 * strlen(rel) + 8, 1), *to = stpcpy(out, made ? "../" : "../../");
	for (const char *p = made ? rel + strlen(work) : rel; *p; p++)
		if (isalnum((unsigned char)*p) || strchr("-._~/", *p))
			*to++ = *p;
		else
			to += sprintf(to, "%%%02X", (unsigned char)*p);
	json_t *json = json_string(out);
	free(out);
	return json;
}

static void put_link(json_t *picture, struct page *page, const char *path)
{
	json_t *whole = picture ? link_of(page, path) : 0;
	if (whole)
		json_object_set_new(picture, "whole", whole);
}

json_t *page_picture(struct page *page, const char *path, int width)
{
	struct err err = { 0 };
	uint8_t *px;
	int w, h;
	if (!path || !picture_read_small(&px, &w, &h, path, width, page->conf->limit_mpx, &err))
		return 0;
	json_t *picture = pixels_at_most(px, w, h, width);
	free(px);
	put_link(picture, page, path);
	return picture;
}

json_t *page_picture_part(struct page *page, const char *path, const int box[4], int width)
{
	struct err err = { 0 };
	uint8_t *px;
	int w, h;
	if (!path || !picture_read(&px, &w, &h, path, page->conf->limit_mpx, &err))
		return 0;
	const bool within = box[0] >= 0 && box[1] >= 0 && box[2] > 0 && box[3] > 0 && box[0] + box[2] <= w && box[1] + box[3] <= h;
	for (int y = 0; y < box[3] && within; y++)
		memmove(px + 3L * y * box[2], px + 3L * ((long)(y + box[1]) * w + box[0]), 3 * (size_t)box[2]);
	json_t *picture = within ? pixels_at_most(px, box[2], box[3], width) : 0;
	free(px);
	return picture;
}

bool page_panels(json_t *out[3], struct page *page, const char *path)
{
	struct err err = { 0 };
	uint8_t *px;
	int w, h;
	if (!path || !picture_read(&px, &w, &h, path, page->conf->limit_mpx, &err))
		return false;
	int width = (w - 2 * COMPARE_GAP) / 3;
#pragma omp parallel for
	for (int k = 0; k < 3; k++) {
		uint8_t *part = mem_array((size_t)width * (size_t)h * 3, 1);
		for (int y = 0; y < h; y++)
			memcpy(part + 3L * y * width, px + 3L * (y * w + k * (width + COMPARE_GAP)), 3 * (size_t)width);
		out[k] = pixels_at_most(part, width, h, page->width);
		free(part);
	}
	free(px);
	for (int k = 0; k < 3; k++) {
		put_link(out[k], page, path);
		json_object_set_new(out[k], "third", page_text("%d", k));
	}
	return true;
}

bool page_map(struct image *out, struct page *page, const char *path, int n, const char *const names[])
{
	struct err err = { 0 };
	struct image in;
	if (!path || !exr_read(&in, path, n, names, 1L << 27, 0, &err))
		return false;
	for (long i = 0; i < (long)in.width * in.height * n; i++)
		if (!isfinite(in.px[i]))
			in.px[i] = 0;
	if (in.width <= page->width) {
		*out = in;
		return true;
	}
	int w = page->width, h = (int)lrint((double)in.height * w / in.width);
	*out = image_new(w, h, n);
	bool ok = cv_resize(out->px, w, h, in.px, in.width, in.height, n, &err);
	image_free(&in);
	if (!ok)
		image_free(out);
	return ok;
}

static json_t *linear_picture(struct image *rgb)
{
	uint8_t *px = image_to_srgb8(rgb);
	json_t *picture = web_picture(px, rgb->width, rgb->height);
	free(px);
	image_free(rgb);
	return picture;
}

json_t *page_colour_map(const struct image *rgbw)
{
	struct image rgb = pseudocolour_seen(rgbw);
	return linear_picture(&rgb);
}

json_t *page_mask_map(const struct image *mask, const struct image *rgbw)
{
	if (mask->width != rgbw->width || mask->height != rgbw->height)
		return 0;
	struct image rgb = pseudocolour_mask(mask, rgbw);
	return linear_picture(&rgb);
}

json_t *page_scalar_map(const struct image *map, int channel, double range[2])
{
	struct image rgb = pseudocolour_scalar(map, channel, range);
	return linear_picture(&rgb);
}

json_t *page_relief_map(const struct image *map, double range[2])
{
	struct image rgb = pseudocolour_relief(map, range);
	return linear_picture(&rgb);
}
