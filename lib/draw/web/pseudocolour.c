#include "draw/web/pseudocolour.h"

#include <math.h>
#include <stdlib.h>

#include "base/mem.h"

struct image pseudocolour_seen(const struct image *map)
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

struct image pseudocolour_mask(const struct image *mask, const struct image *rgbw)
{
	static const float accent[3] = { 1.0f, 0.32f, 0.05f };
	struct image rgb = pseudocolour_seen(rgbw);
	for (int y = 0; y < rgb.height; y++)
		for (int x = 0; x < rgb.width; x++) {
			bool in = *image_at(mask, x, y) > 0.5f, edge = on_edge(mask, x, y);
			for (int c = 0; c < 3; c++) {
				float *p = &image_at(&rgb, x, y)[c];
				*p = edge ? accent[c] : in ? *p : 0.55f * *p;  // the rest of the iris a little dimmed
			}
		}
	return rgb;
}

/* Colour ramp, t 0..1: dark blue, green, yellow in even steps of lightness. The table is sRGB, the result linear. */
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

/* The 1st and 99th percentile of a channel. */
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

struct image pseudocolour_scalar(const struct image *map, int channel, double range[2])
{
	spread(range, map, channel);
	struct image rgb = image_new(map->width, map->height, 3);
	for (long i = 0; i < (long)map->width * map->height; i++)
		ramp(rgb.px + 3 * i, (float)((map->px[i * map->channels + channel] - range[0]) / fmax(range[1] - range[0], 1e-9)));
	return rgb;
}

struct image pseudocolour_relief(const struct image *map, double range[2])
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
	return rgb;
}
