#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "bridge/cv_blur.h"
#include "bridge/cv_photo.h"
#include "image/exr.h"
#include "image/picture.h"
#include "render/page/page.h"

enum { JPEG_QUALITY = 86 };

char *page_base64(const uint8_t *data, size_t size, const char *head)
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
	char *uri = page_base64(data, size, "data:image/jpeg;base64,");
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
	json_t *picture = page_pixels(px, rgb->width, rgb->height);
	free(px);
	image_free(rgb);
	return picture;
}

/* Colour where a photograph saw it; dark stripes elsewhere. */
static struct image seen_colour(const struct image *map)
{
	struct image rgb = image_new(map->width, map->height, 3);
	for (int y = 0; y < map->height; y++)
		for (int x = 0; x < map->width; x++) {
			const float *p = image_at(map, x, y);
			float w = p[3] > 0.05f ? 1 : p[3] / 0.05f, stripe = (x + y) / 5 % 2 ? 0.012f : 0.022f;
			for (int c = 0; c < 3; c++)
				image_at(&rgb, x, y)[c] = w * p[c] + (1 - w) * stripe;
		}
	return rgb;
}

json_t *page_colour_map(const struct image *rgbw)
{
	struct image rgb = seen_colour(rgbw);
	return linear_picture(&rgb);
}

static bool on_edge(const struct image *mask, int x, int y)
{
	static const int step[8][2] = { { -2, 0 }, { 2, 0 }, { 0, -2 }, { 0, 2 }, { -1, -1 }, { 1, 1 }, { -1, 1 }, { 1, -1 } };
	bool in = *image_at(mask, x, y) > 0.5f, edge = false;
	for (int k = 0; k < 8; k++) {
		int u = x + step[k][0], v = y + step[k][1];
		if (u >= 0 && v >= 0 && u < mask->width && v < mask->height)
			edge = edge || (*image_at(mask, u, v) > 0.5f) != in;
	}
	return edge;
}

json_t *page_mask_map(const struct image *mask, const struct image *rgbw)
{
	static const float accent[3] = { 1.0f, 0.32f, 0.05f };
	if (mask->width != rgbw->width || mask->height != rgbw->height)
		return 0;
	struct image rgb = seen_colour(rgbw);
	for (int y = 0; y < rgb.height; y++)
		for (int x = 0; x < rgb.width; x++) {
			bool in = *image_at(mask, x, y) > 0.5f, edge = on_edge(mask, x, y);
			for (int c = 0; c < 3; c++) {
				float *p = &image_at(&rgb, x, y)[c];
				*p = edge ? accent[c] : in ? *p : 0.55f * *p;  // the rest of the iris a little dimmed
			}
		}
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

/* Between the first and the last hundredth of the values of a channel: what the colours span. */
static void spread(double range[2], const struct image *map, int channel)
{
	long n = ((long)map->width * map->height + 6) / 7;  // every seventh texel says it as well
	float *sorted = mem_array((size_t)n, sizeof *sorted);
	for (long i = 0; i < n; i++)
		sorted[i] = map->px[7 * i * map->channels + channel];
	qsort(sorted, (size_t)n, sizeof *sorted, compare_floats);
	range[0] = sorted[n / 100];
	range[1] = sorted[n - 1 - n / 100];
	free(sorted);
}

json_t *page_scalar_map(const struct image *map, int channel, double range[2])
{
	spread(range, map, channel);
	struct image rgb = image_new(map->width, map->height, 3);
	for (long i = 0; i < (long)map->width * map->height; i++)
		ramp(rgb.px + 3 * i, (float)((map->px[i * map->channels + channel] - range[0]) / fmax(range[1] - range[0], 1e-9)));
	return linear_picture(&rgb);
}

/* Lit from the upper left; the slope is scaled by its own size, so that shallow reliefs show, too. */
json_t *page_relief_map(const struct image *map, double range[2])
{
	int step = map->channels;
	long n = (long)map->width * map->height;
	double sum = 0;
	spread(range, map, 0);
	for (long i = 1; i < n; i++)
		sum += fabs(map->px[i * step] - map->px[(i - 1) * step]);
	float k = (float)(0.28 / fmax(sum / (double)n, 1e-9));
	struct image rgb = image_new(map->width, map->height, 3);
	for (int y = 0; y < map->height; y++)
		for (int x = 0; x < map->width; x++) {
			float here = *image_at(map, x, y), gx = k * (here - *image_at(map, x ? x - 1 : x, y)),
			      gy = k * (here - *image_at(map, x, y ? y - 1 : y));
			float light = (0.78f + 0.40f * (gx + gy)) / sqrtf(1 + gx * gx + gy * gy), shade = 0.66f * light;
			shade = shade > 0 ? shade < 1 ? shade : 1 : 0;
			for (int c = 0; c < 3; c++)
				image_at(&rgb, x, y)[c] = shade * shade * (c == 2 ? 0.93f : 1);
		}
	return linear_picture(&rgb);
}
