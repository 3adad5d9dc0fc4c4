/* Maps for the interactive page. */
#include <math.h>
#include <stdlib.h>

#include "base/json.h"
#include "base/mem.h"
#include "eye/scene_impl.h"
#include "image/picture.h"
#include "render/page.h"
#include "render/viewer.h"

static json_t *png(const uint8_t *px, int width, int height, int channels, const double low[3], const double high[3],
                   struct err *err)
{
	uint8_t *data;
	size_t size;
	if (!picture_png_encode(&data, &size, px, width, height, channels, err))
		return 0;
	char *text = page_base64(data, size, "");
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

/* 12 bits of height in two channels, 8 of thickness in the third. */
json_t *viewer_map_relief(const struct scene_level *level, struct err *err)
{
	double low[3] = { INFINITY, INFINITY }, high[3] = { -INFINITY, -INFINITY };
	long n = (long)level->n * level->n;
	for (long i = 0; i < n; i++)
		for (int c = 0; c < 2; c++) {
			low[c] = fmin(low[c], level->relief[2 * i + c]);
			high[c] = fmax(high[c], level->relief[2 * i + c]);
		}
	for (int c = 0; c < 2; c++)
		high[c] = fmax(high[c], low[c] + 1e-6);
	uint8_t *px = mem_array((size_t)n * 3, 1);
	for (long i = 0; i < n; i++) {
		int h = (int)lrint((level->relief[2 * i] - low[0]) / (high[0] - low[0]) * 4095);
		px[3 * i] = (uint8_t)(h >> 4);
		px[3 * i + 1] = (uint8_t)((h & 15) * 17);
		px[3 * i + 2] = byte((level->relief[2 * i + 1] - low[1]) / (high[1] - low[1]));
	}
	json_t *map = png(px, level->n, level->n, 3, low, high, err);
	free(px);
	return map;
}

json_t *viewer_map_colour(const struct scene_level *level, struct err *err)
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

json_t *viewer_map_log(const float *px, int width, int height, int stride, float dark, struct err *err)
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

json_t *viewer_map_plain(const struct image *map, struct err *err)
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

json_t *viewer_light(const char *name, const struct envmap *env, const struct envmap *mirror, int lights, struct err *err)
{
	struct envmap_light light[ENVMAP_LIGHTS_MAX];
	int n = envmap_lights(light, lights, env);
	json_t *out = json_pack("{s:s}", "name", name), *list = json_array(), *quadric = json_array();
	for (int i = 0; i < n; i++) {
		double v[6];
		for (int c = 0; c < 3; c++) {
			v[c] = light[i].dir[c];
			v[3 + c] = light[i].rgb[c];
		}
		json_array_append_new(list, json_numbers(6, v));
	}
	for (int k = 0; k < 9; k++) {
		double v[3] = { env->quadric[k][0], env->quadric[k][1], env->quadric[k][2] };
		json_array_append_new(quadric, json_numbers(3, v));
	}
	double even[3];
	for (int c = 0; c < 3; c++)
		even[c] = env->sh[0][c] * 0.282094791773878;
	json_object_set_new(out, "lights", list);
	json_object_set_new(out, "quadric", quadric);
	json_object_set_new(out, "even", json_numbers(3, even));
	if (mirror) {
		const struct image *s = &mirror->sharp, *r = &mirror->rough;
		json_object_set_new(out, "sharp", viewer_map_log(s->px, s->width, s->height, s->channels, SCENE_DARK, err));
		json_object_set_new(out, "rough", viewer_map_log(r->px, r->width, r->height, r->channels, SCENE_DARK, err));
	}
	return out;
}
