/* Lookups without trigonometry: the octahedron |x| + |y| + |z| = 1 is unfolded into a square, -z in its middle and +z at its
 * corners. */
#include <math.h>
#include <stdlib.h>

#include "base/mem.h"
#include "image/envmap/impl.h"

enum { ROUGH = 64, LOW = 32 };  // rows of what the blurred copy is made from: 5.6 degrees

/* Square -1..1 to direction. */
static void unfold_dir(double d[3], double u, double v)
{
	double z = 1 - fabs(u) - fabs(v), x = u, y = v;
	if (z < 0) {
		x = copysign(1 - fabs(v), u);
		y = copysign(1 - fabs(u), v);
	}
	double n = sqrt(x * x + y * y + z * z);
	d[0] = x / n;
	d[1] = y / n;
	d[2] = -z / n;
}

static void map_at(float rgb[3], const struct image *map, const double d[3])
{
	double u = 0.5 + atan2(-d[0], -d[2]) / (2 * M_PI), v = acos(fmin(fmax(-d[1], -1), 1)) / M_PI;
	double x = u * map->width - 0.5, y = v * map->height - 0.5, fx = floor(x), fy = floor(y);
	int w = map->width, h = map->height, x0 = ((int)fx + w) % w, x1 = (x0 + 1) % w, y0 = (int)fy, y1 = y0 + 1;
	float s = (float)(x - fx), t = (float)(y - fy);
	y0 = y0 < 0 ? 0 : y0;
	y1 = y1 > h - 1 ? h - 1 : y1;
	for (int c = 0; c < 3; c++)
		rgb[c] = (1 - t) * ((1 - s) * image_at(map, x0, y0)[c] + s * image_at(map, x1, y0)[c])
		         + t * ((1 - s) * image_at(map, x0, y1)[c] + s * image_at(map, x1, y1)[c]);
}

/* The coarse map from which lobes are made: direction of each pixel, solid angle and polar angle of each row. */
struct low {
	struct image map;
	double (*dirs)[3], weight[LOW], polar[LOW];
};

static struct low low_make(const struct image *map)
{
	struct low low = { .map = envmap_coarse(map, LOW) };
	int w = low.map.width, h = low.map.height;
	low.dirs = mem_array((size_t)w * (size_t)h, sizeof *low.dirs);
	for (int y = 0; y < h; y++) {
		low.weight[y] = envmap_solid_angle(&low.map, y);
		low.polar[y] = M_PI * (y + 0.5) / h;
		for (int x = 0; x < w; x++)
			envmap_dir(low.dirs[y * w + x], (x + 0.5) / w, (y + 0.5) / h);
	}
	return low;
}

/* Mean of the map over a lobe about d: Gaussian of 6 degrees, cut off at three times that. */
static void lobe_at(float rgb[3], const struct low *low, const double d[3])
{
	const double width = 6 * M_PI / 180, k = 1 / (2 * width * width), far = 0.1, reach = 2 * asin(sqrt(far) / 2);
	const double polar = acos(fmin(fmax(-d[1], -1), 1));
	double sum[3] = { 0 }, total = 0;
	for (int y = 0; y < low->map.height; y++) {
		// directions of two rows are at least as far apart as the rows
		if (fabs(low->polar[y] - polar) > reach)
			continue;
		for (int x = 0; x < low->map.width; x++) {
			const double *e = low->dirs[y * low->map.width + x];
			double off = 2 - 2 * (d[0] * e[0] + d[1] * e[1] + d[2] * e[2]);  // the chord's square
			if (off > far)
				continue;
			double w = low->weight[y] * exp(-k * off);
			total += w;
			for (int c = 0; c < 3; c++)
				sum[c] += w * image_at(&low->map, x, y)[c];
		}
	}
	for (int c = 0; c < 3; c++)
		rgb[c] = (float)(total > 0 ? sum[c] / total : 0);
}

/* Second difference at a pixel (0..width - 1 each way), the larger of both directions, channels summed. */
static float bend_at(const struct image *map, int x, int y)
{
	float most = 0;
	for (int k = 0; k < 2; k++) {
		int at = k ? y : x, off = k ? 4 * map->width : 4;
		if (at < 1 || at > map->width - 2)
			continue;
		const float *p = image_at(map, x, y);
		float sum = 0;
		for (int c = 0; c < 3; c++)
			sum += fabsf(p[c - off] - 2 * p[c] + p[c + off]);
		most = sum > most ? sum : most;
	}
	return most;
}

/* The greatest second difference of each block and the pixels round it. */
static void bends(struct envmap *env)
{
	int n = env->sharp.width, m = (n + ENVMAP_BLOCK - 1) / ENVMAP_BLOCK;
	env->bend = image_new(m, m, 1);
#pragma omp parallel for schedule(static)
	for (int by = 0; by < m; by++)
		for (int bx = 0; bx < m; bx++) {
			float most = 0;
			for (int y = by * ENVMAP_BLOCK - 1; y <= (by + 1) * ENVMAP_BLOCK; y++)
				for (int x = bx * ENVMAP_BLOCK - 1; x <= (bx + 1) * ENVMAP_BLOCK; x++)
					if (x >= 0 && y >= 0 && x < n && y < n)
						most = fmaxf(most, bend_at(&env->sharp, x, y));
			*image_at(&env->bend, bx, by) = most;
		}
}

void envmap_unfold(struct envmap *env)
{
	int n = 2 * env->map.height;
	struct low low = low_make(&env->map);
	env->sharp = image_new(n, n, 4);
	env->rough = image_new(ROUGH, ROUGH, 4);
#pragma omp parallel for schedule(static)
	for (int y = 0; y < n; y++)
		for (int x = 0; x < n; x++) {
			double d[3];
			unfold_dir(d, (2 * x + 1.0) / n - 1, (2 * y + 1.0) / n - 1);
			map_at(image_at(&env->sharp, x, y), &env->map, d);
		}
#pragma omp parallel for schedule(static)
	for (int y = 0; y < ROUGH; y++)
		for (int x = 0; x < ROUGH; x++) {
			double d[3];
			unfold_dir(d, (2 * x + 1.0) / ROUGH - 1, (2 * y + 1.0) / ROUGH - 1);
			lobe_at(image_at(&env->rough, x, y), &low, d);
		}
	free(low.dirs);
	image_free(&low.map);
	bends(env);
}

static void square_at(float rgb[3], const struct image *map, float u, float v)
{
	float top = (float)map->width - 1.001f;
	u = (u + 1) * 0.5f * (float)map->width - 0.5f;
	v = (v + 1) * 0.5f * (float)map->width - 0.5f;
	u = u > 0 ? u < top ? u : top : 0;
	v = v > 0 ? v < top ? v : top : 0;
	int x = (int)u, y = (int)v;
	const float *a = image_at(map, x, y), *b = a + 4L * map->width;
	u -= (float)x;
	v -= (float)y;
	for (int c = 0; c < 3; c++)
		rgb[c] = (1 - v) * ((1 - u) * a[c] + u * a[c + 4]) + v * ((1 - u) * b[c] + u * b[c + 4]);
}

void envmap_at(float rgb[3], const struct envmap *env, const float d[3], float rough)
{
	float inv = 1 / (fabsf(d[0]) + fabsf(d[1]) + fabsf(d[2])), u = d[0] * inv, v = d[1] * inv, blurred[3];
	if (d[2] > 0) {
		float x = u;
		u = copysignf(1 - fabsf(v), x);
		v = copysignf(1 - fabsf(x), v);
	}
	square_at(rgb, &env->sharp, u, v);
	if (rough > 0) {
		square_at(blurred, &env->rough, u, v);
		for (int c = 0; c < 3; c++)
			rgb[c] += rough * (blurred[c] - rgb[c]);
	}
}
