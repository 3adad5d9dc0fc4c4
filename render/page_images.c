#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "bridge/cv_blur.h"
#include "bridge/cv_photo.h"
#include "image/exr.h"
#include "image/picture.h"
#include "render/page.h"

enum { JPEG_QUALITY = 86 };

static char *base64(const uint8_t *data, size_t size, const char *head)
{
	static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
	char *out = mem_array(strlen(head) + (size + 2) / 3 * 4 + 1, 1), *at = out + strlen(head);
	strcpy(out, head);
	for (size_t i = 0; i < size; i += 3) {
		size_t n = size - i;
		unsigned v = (unsigned)data[i] << 16 | (n > 1 ? data[i + 1] : 0u) << 8 | (n > 2 ? data[i + 2] : 0u);
		*at++ = digits[v >> 18];
		*at++ = digits[v >> 12 & 63];
		*at++ = n > 1 ? digits[v >> 6 & 63] : '=';
		*at++ = n > 2 ? digits[v & 63] : '=';
	}
	*at = 0;
	return out;
}

json_t *page_pixels(const uint8_t *px, int width, int height)
{
	struct err err = { 0 };
	uint8_t *data;
	size_t size;
	if (!picture_jpeg_encode(&data, &size, px, width, height, 3, JPEG_QUALITY, &err))
		return 0;
	char *uri = base64(data, size, "data:image/jpeg;base64,");
	json_t *picture = json_pack("{s:s,s:i,s:i}", "uri", uri, "width", width, "height", height);
	free(uri);
	free(data);
	return picture;
}

static json_t *pixels_at_most(const uint8_t *px, int w, int h, int width)
{
	if (w <= width)
		return page_pixels(px, w, h);
	int height = (int)fmax(lrint((double)h * width / w), 1);
	uint8_t *small = cv_resize8(px, w, h, 3, width, height);
	json_t *picture = page_pixels(small, width, height);
	free(small);
	return picture;
}

json_t *page_picture(struct page *page, const char *path, int width)
{
	struct err err = { 0 };
	uint8_t *px;
	int w, h;
	if (!path || !picture_read(&px, &w, &h, path, page->conf->limit_mpx, &err))
		return 0;
	json_t *picture = pixels_at_most(px, w, h, width);
	free(px);
	return picture;
}

json_t *page_panel(struct page *page, const char *path, int panel)
{
	struct err err = { 0 };
	uint8_t *px;
	int w, h;
	if (!path || !picture_read(&px, &w, &h, path, page->conf->limit_mpx, &err))
		return 0;
	int width = (w - 2 * COMPARE_GAP) / 3, at = panel * (width + COMPARE_GAP);
	uint8_t *part = mem_array((size_t)width * (size_t)h * 3, 1);
	for (int y = 0; y < h; y++)
		memcpy(part + 3L * y * width, px + 3L * (y * w + at), 3 * (size_t)width);
	json_t *picture = pixels_at_most(part, width, h, page->width);
	free(part);
	free(px);
	return picture;
}

/* Channels of a map, at most the page's width. image_free. */
static bool map_read(struct image *out, struct page *page, const char *path, int n, const char *const names[])
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
	json_t *picture = page_pixels(px, rgb->width, rgb->height);
	free(px);
	image_free(rgb);
	return picture;
}

/* Colour where a photograph saw it; dark stripes elsewhere. */
static bool seen_colour(struct image *rgb, struct page *page, const char *path)
{
	static const char *const names[] = { "R", "G", "B", "W" };
	struct image map;
	if (!map_read(&map, page, path, 4, names))
		return false;
	*rgb = image_new(map.width, map.height, 3);
	for (int y = 0; y < map.height; y++)
		for (int x = 0; x < map.width; x++) {
			const float *p = image_at(&map, x, y);
			float w = p[3] > 0.05f ? 1 : p[3] / 0.05f, stripe = (x + y) / 5 % 2 ? 0.012f : 0.022f;
			for (int c = 0; c < 3; c++)
				image_at(rgb, x, y)[c] = w * p[c] + (1 - w) * stripe;
		}
	image_free(&map);
	return true;
}

json_t *page_colour_map(struct page *page, const char *path)
{
	struct image rgb;
	return seen_colour(&rgb, page, path) ? linear_picture(&rgb) : 0;
}

json_t *page_mask_map(struct page *page, const char *path, const char *colour_path)
{
	static const char *const names[] = { "Y" };
	static const float accent[3] = { 1.0f, 0.32f, 0.05f };
	struct image rgb, mask;
	if (!seen_colour(&rgb, page, colour_path))
		return 0;
	if (!map_read(&mask, page, path, 1, names) || mask.width != rgb.width || mask.height != rgb.height) {
		image_free(&rgb);
		return 0;
	}
	for (int y = 0; y < rgb.height; y++)
		for (int x = 0; x < rgb.width; x++) {
			// The outline of each region, two pixels wide, and the rest of the iris a little dimmed.
			bool in = mask.px[y * rgb.width + x] > 0.5f, edge = false;
			for (int k = 0; k < 8; k++) {
				static const int step[8][2] = { { -2, 0 }, { 2, 0 }, { 0, -2 }, { 0, 2 }, { -1, -1 }, { 1, 1 }, { -1, 1 }, { 1, -1 } };
				int u = x + step[k][0], v = y + step[k][1];
				if (u >= 0 && v >= 0 && u < rgb.width && v < rgb.height)
					edge = edge || (mask.px[v * rgb.width + u] > 0.5f) != in;
			}
			for (int c = 0; c < 3; c++) {
				float *p = &image_at(&rgb, x, y)[c];
				*p = edge ? accent[c] : in ? *p : 0.55f * *p;
			}
		}
	image_free(&mask);
	return linear_picture(&rgb);
}

/* Dark blue through green to yellow, even steps of lightness; sRGB. */
static void ramp(float rgb[3], float t)
{
	static const float at[6][3] = { { 0.267f, 0.005f, 0.329f }, { 0.254f, 0.265f, 0.530f }, { 0.164f, 0.471f, 0.558f },
		                            { 0.135f, 0.659f, 0.518f }, { 0.478f, 0.821f, 0.318f }, { 0.993f, 0.906f, 0.144f } };
	t = fminf(fmaxf(t, 0), 1) * 5;
	int i = t < 4 ? (int)t : 4;
	for (int c = 0; c < 3; c++)
		rgb[c] = linear_from_srgb(at[i][c] + (t - (float)i) * (at[i + 1][c] - at[i][c]));
}

static int compare_floats(const void *a, const void *b)
{
	float x = *(const float *)a, y = *(const float *)b;
	return (x > y) - (x < y);
}

/* Between the first and the last hundredth of the values of a map: what the colours span. */
static void spread(double range[2], const struct image *map)
{
	long n = (long)map->width * map->height;
	float *sorted = mem_array((size_t)n, sizeof *sorted);
	memcpy(sorted, map->px, (size_t)n * sizeof *sorted);
	qsort(sorted, (size_t)n, sizeof *sorted, compare_floats);
	range[0] = sorted[n / 100];
	range[1] = sorted[n - 1 - n / 100];
	free(sorted);
}

json_t *page_scalar_map(struct page *page, const char *path, const char *channel, double range[2])
{
	struct image map;
	if (!map_read(&map, page, path, 1, &channel))
		return 0;
	spread(range, &map);
	struct image rgb = image_new(map.width, map.height, 3);
	for (long i = 0; i < (long)map.width * map.height; i++)
		ramp(rgb.px + 3 * i, (float)((map.px[i] - range[0]) / fmax(range[1] - range[0], 1e-9)));
	image_free(&map);
	return linear_picture(&rgb);
}

json_t *page_relief_map(struct page *page, const char *path, double range[2])
{
	static const char *const names[] = { "Y" };
	struct image map;
	if (!map_read(&map, page, path, 1, names))
		return 0;
	spread(range, &map);
	// Lit from the upper left; the slope is scaled by its own size, so that shallow reliefs show, too.
	double sum = 0;
	long n = (long)map.width * map.height;
	for (long i = 1; i < n; i++)
		sum += fabs(map.px[i] - map.px[i - 1]);
	float k = (float)(0.55 / fmax(sum / (double)n, 1e-9));
	struct image rgb = image_new(map.width, map.height, 3);
	for (int y = 0; y < map.height; y++)
		for (int x = 0; x < map.width; x++) {
			float here = *image_at(&map, x, y), left = *image_at(&map, x ? x - 1 : x, y), up = *image_at(&map, x, y ? y - 1 : y);
			float gx = k * (here - left), gy = k * (here - up), light = (0.80f - 0.42f * (gx + gy) * -1) / sqrtf(1 + gx * gx + gy * gy);
			for (int c = 0; c < 3; c++)
				image_at(&rgb, x, y)[c] = powf(fminf(fmaxf(0.62f * light, 0), 1), 2.2f) * (c == 2 ? 0.92f : 1);
		}
	image_free(&map);
	return linear_picture(&rgb);
}
