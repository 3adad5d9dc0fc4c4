#include "iris/unrefract/sample.h"

#include <math.h>
#include <string.h>

#include "base/mem.h"

float map_resolution(const struct iris_map *map, int col, int row)
{
	long i = (long)row * map->size + col;
	int right = col + 1 < map->size ? 1 : -1, below = row + 1 < map->size ? 1 : -1;
	long j = i + right, k = i + (long)below * map->size;
	float a = map->u[j] - map->u[i], b = map->u[k] - map->u[i], c = map->v[j] - map->v[i], d = map->v[k] - map->v[i];
	// smaller singular value of [a b; c d]
	float sum = a * a + b * b + c * c + d * d, det = fabsf(a * d - b * c);
	float root = sqrtf(fmaxf(sum * sum - 4 * det * det, 0));
	float small = sqrtf(fmaxf((sum - root) / 2, 0));
	return isfinite(small) ? small : 0;
}

struct box {
	float x0, y0, x1, y1;
};

static struct box map_bounds(const struct iris_map *map)
{
	struct box box = { INFINITY, INFINITY, -INFINITY, -INFINITY };
	for (long i = 0; i < (long)map->size * map->size; i++) {
		float u = map->u[i], v = map->v[i];
		if (!isfinite(u + v))
			continue;
		box.x0 = fminf(box.x0, u), box.x1 = fmaxf(box.x1, u);
		box.y0 = fminf(box.y0, v), box.y1 = fmaxf(box.y1, v);
	}
	return box;
}

/* Photo pixels a texel covers in the middle of the map. */
static double map_pitch(const struct iris_map *map)
{
	int m = map->size / 2;
	float r = map_resolution(map, m, m);
	return r > 0 ? r : 1;
}

/* Averages rows [y, y + step) of the photograph into one row of the crop. */
static void crop_row(struct crop *crop, const struct photo *photo, int row)
{
	int s = crop->step, w = crop->image.width;
	struct image strip = photo_linear(photo, crop->x0, crop->y0 + row * s, w * s, s);
	float scale = 1.0f / (float)(s * s), *out = image_at(&crop->image, 0, row);
	for (int y = 0; y < s; y++)
		for (int x = 0; x < w * s; x++)
			for (int c = 0; c < 3; c++)
				out[x / s * 3 + c] += scale * strip.px[((long)y * w * s + x) * 3 + c];
	image_free(&strip);
}

struct crop crop_new(const struct photo *photo, const struct iris_map *map)
{
	struct box box = map_bounds(map);
	struct crop crop = { .step = (int)fmax(1, floor(map_pitch(map) + 0.25)) };
	int s = crop.step, margin = 3 * s;
	crop.x0 = (int)fmaxf(0, box.x0 - (float)margin);
	crop.y0 = (int)fmaxf(0, box.y0 - (float)margin);
	int x1 = (int)fminf((float)photo->width, box.x1 + (float)margin);
	int y1 = (int)fminf((float)photo->height, box.y1 + (float)margin);
	int w = (x1 - crop.x0) / s, h = (y1 - crop.y0) / s;
	if (!(box.x1 > box.x0) || w < 4 || h < 4)
		return crop;
	if (s == 1) {
		crop.image = photo_linear(photo, crop.x0, crop.y0, w, h);
		return crop;
	}
	crop.image = image_new(w, h, 3);
#pragma omp parallel for schedule(static)
	for (int row = 0; row < h; row++)
		crop_row(&crop, photo, row);
	return crop;
}

void crop_free(struct crop *crop)
{
	image_free(&crop->image);
}

static void cubic(float w[4], float t)
{
	w[0] = t * (-0.5f + t * (1 - 0.5f * t));
	w[1] = 1 + t * t * (-2.5f + 1.5f * t);
	w[2] = t * (0.5f + t * (2 - 1.5f * t));
	w[3] = t * t * (-0.5f + 0.5f * t);
}

/* Bicubic (Catmull-Rom) at (x, y) of the crop; false outside. */
static bool sample(float rgb[3], const struct image *image, float x, float y)
{
	float fx = floorf(x - 0.5f), fy = floorf(y - 0.5f);
	int x0 = (int)fx - 1, y0 = (int)fy - 1;
	if (!(x0 >= 0 && y0 >= 0 && x0 + 3 < image->width && y0 + 3 < image->height))
		return false;
	float wx[4], wy[4], sum[3] = { 0 };
	cubic(wx, x - 0.5f - fx);
	cubic(wy, y - 0.5f - fy);
	for (int j = 0; j < 4; j++) {
		const float *p = image_at(image, x0, y0 + j);
		for (int c = 0; c < 3; c++)
			sum[c] += wy[j] * (wx[0] * p[c] + wx[1] * p[3 + c] + wx[2] * p[6 + c] + wx[3] * p[9 + c]);
	}
	for (int c = 0; c < 3; c++)
		rgb[c] = fmaxf(sum[c], 0);
	return true;
}

long crop_sample(float *rgb, const struct crop *crop, const struct iris_map *map, const uint8_t *skip)
{
	long n = 0;
	float scale = 1.0f / (float)crop->step;
	memset(rgb, 0, (size_t)map->size * (size_t)map->size * 3 * sizeof *rgb);
	if (!crop->image.px)
		return 0;
#pragma omp parallel for schedule(dynamic, 8) reduction(+ : n)
	for (int row = 0; row < map->size; row++)
		for (int col = 0; col < map->size; col++) {
			long i = (long)row * map->size + col;
			if ((skip && skip[i]) || !isfinite(map->u[i]))
				continue;
			float x = (map->u[i] - (float)crop->x0) * scale, y = (map->v[i] - (float)crop->y0) * scale;
			n += sample(rgb + 3 * i, &crop->image, x, y);
		}
	return n;
}
