#include "draw/web/map.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/json.h"
#include "base/mem.h"
#include "draw/eye/colour.h"
#include "draw/eye/levels.h"
#include "draw/web/base64.h"
#include "image/picture.h"

static json_t *png(const uint8_t *px, int width, int height, int channels, const double low[3], const double high[3],
                   struct err *err)
{
	uint8_t *data;
	size_t size;
	if (!picture_png_encode(&data, &size, px, width, height, channels, err))
		return 0;
	char *text = base64_encode(data, size, "");
	json_t *map = json_pack("{s:s,s:i,s:i}", "png", text, "width", width, "height", height);
	json_object_set_new(map, "low", json_numbers(3, low));
	json_object_set_new(map, "high", json_numbers(3, high));
	free(text);
	free(data);
	return map;
}

static uint8_t byte(double t)
{
	return (uint8_t)lrint(255 * fmin(fmax(t, 0), 1));
}

/* px[height][width][2]: the first number as 12 bits in two channels, the second as 8 bits in the third. */
static json_t *map_height(const float *px, int width, int height, struct err *err)
{
	double low[3] = { INFINITY, INFINITY }, high[3] = { -INFINITY, -INFINITY };
	long n = (long)width * height;
	for (long i = 0; i < n; i++)
		for (int c = 0; c < 2; c++) {
			low[c] = fmin(low[c], px[2 * i + c]);
			high[c] = fmax(high[c], px[2 * i + c]);
		}
	for (int c = 0; c < 2; c++)
		high[c] = fmax(high[c], low[c] + 1e-6);
	uint8_t *out = mem_array((size_t)n * 3, 1);
	for (long i = 0; i < n; i++) {
		int h = (int)lrint((px[2 * i] - low[0]) / (high[0] - low[0]) * 4095);
		out[3 * i] = (uint8_t)(h >> 4);
		out[3 * i + 1] = (uint8_t)((h & 15) * 17);
		out[3 * i + 2] = byte((px[2 * i + 1] - low[1]) / (high[1] - low[1]));
	}
	json_t *map = png(out, width, height, 3, low, high, err);
	free(out);
	return map;
}

json_t *web_map_relief(const struct scene_level *level, struct err *err)
{
	return map_height(level->relief, level->n, level->n, err);
}

json_t *web_map_folds(const struct image *map, int n, const int of[], struct err *err)
{
	long count = (long)map->width * map->height;
	float *px = mem_array((size_t)count * (size_t)n * 2, sizeof *px);
	for (int k = 0; k < n; k++)
		for (long i = 0; i < count; i++)
			memcpy(px + 2 * (k * count + i), map->px + map->channels * i + 2 * of[k], 2 * sizeof *px);
	json_t *out = map_height(px, map->width, n * map->height, err);
	free(px);
	return out;
}

json_t *web_map_colour(const struct scene_level *level, struct err *err)
{
	static const double low[3] = { 0 }, high[3] = { 1, 1, 1 };
	struct image rgb = image_new(level->n, level->n, 3);
	for (long i = 0; i < (long)level->n * level->n; i++)
		for (int c = 0; c < 3; c++)
			rgb.px[3 * i + c] = level->colour[4 * i + c];
	uint8_t *px = image_to_srgb8(&rgb);
	json_t *map = png(px, level->n, level->n, 3, low, high, err);
	free(px);
	image_free(&rgb);
	return map;
}

json_t *web_map_log(const float *px, int width, int height, int stride, float dark, struct err *err)
{
	float low[3] = { INFINITY, INFINITY, INFINITY }, high[3] = { -INFINITY, -INFINITY, -INFINITY };
	long n = (long)width * height;
	float *value = mem_array((size_t)n * 3, sizeof *value);
	uint8_t *out = mem_array((size_t)n * 3, 1);
	for (long i = 0; i < n; i++)
		for (int c = 0; c < 3; c++) {
			float v = value[3 * i + c] = logf(fmaxf(px[stride * i + c], dark));
			low[c] = v < low[c] ? v : low[c];
			high[c] = v > high[c] ? v : high[c];
		}
	double from[3], to[3];
	for (int c = 0; c < 3; c++) {
		from[c] = low[c];
		to[c] = high[c] = fmaxf(high[c], low[c] + 1e-6f);
	}
	for (long i = 0; i < n; i++)
		for (int c = 0; c < 3; c++)
			out[3 * i + c] = (uint8_t)(255 * (value[3 * i + c] - low[c]) / (high[c] - low[c]) + 0.5f);
	free(value);
	json_t *map = png(out, width, height, 3, from, to, err);
	free(out);
	return map;
}

/* The least value of the model's map inside the iris: the eight bits span from there. */
static float darkest(const struct scene *s, const struct scene_level *l)
{
	float least = 1, reach = (float)(fmax(s->limbus[0], s->limbus[1]) * l->per_mm), middle = 0.5f * (float)l->n;
	for (int y = 0; y < l->n; y++)
		for (int x = 0; x < l->n; x++)
			for (int c = 0; c < 3 && hypotf((float)x + 0.5f - middle, (float)y + 0.5f - middle) <= reach; c++)
				least = fminf(least, l->model[4 * ((long)y * l->n + x) + c]);
	return fmaxf(least, SCENE_DARK);
}

json_t *web_map_model(const struct scene *s, struct err *err)
{
	int from = scene_marched(s) < s->n_levels ? scene_marched(s) : s->n_levels - 1, rows = 0;
	const struct scene_level *first = &s->level[from];
	float dark = darkest(s, first), *all;
	json_t *tops = json_array();
	for (int k = from; k < s->n_levels; k++) {
		json_array_append_new(tops, json_integer(rows));
		rows += s->level[k].n;
	}
	all = mem_array((size_t)first->n * (size_t)rows * 4, sizeof *all);
	for (long i = 0; i < 4L * first->n * rows; i++)
		all[i] = dark;
	for (int k = from, y = 0; k < s->n_levels; y += s->level[k++].n)
		for (int row = 0; row < s->level[k].n; row++)
			memcpy(all + 4L * first->n * (y + row), s->level[k].model + 4L * s->level[k].n * row, 4 * (size_t)s->level[k].n * sizeof *all);
	json_t *map = web_map_log(all, first->n, rows, 4, dark, err);
	free(all);
	if (map) {
		json_object_set_new(map, "from", json_integer(from));
		json_object_set(map, "tops", tops);
	}
	json_decref(tops);
	return map;
}

json_t *web_map_plain(const struct image *map, struct err *err)
{
	double low[3] = { 0 }, high[3] = { 1, 1, 1 };
	int n = map->channels < 3 ? map->channels : 3;
	long count = (long)map->width * map->height;
	uint8_t *out = mem_new((size_t)count * 3, 1);
	for (int c = 0; c < n; c++) {
		low[c] = INFINITY;
		high[c] = -INFINITY;
		for (long i = 0; i < count; i++) {
			low[c] = fmin(low[c], map->px[map->channels * i + c]);
			high[c] = fmax(high[c], map->px[map->channels * i + c]);
		}
		high[c] = fmax(high[c], low[c] + 1e-6);
		for (long i = 0; i < count; i++)
			out[3 * i + c] = byte((map->px[map->channels * i + c] - low[c]) / (high[c] - low[c]));
	}
	json_t *json = png(out, map->width, map->height, 3, low, high, err);
	free(out);
	return json;
}
