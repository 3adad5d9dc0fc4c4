#include "limbus/propose/flank_map.h"

#include <math.h>
#include <stdlib.h>

#include "base/mem.h"

static const float BLACK = 0.03f;  // encoded; what sensors and JPEG make of black

struct log_map log_map_make(const struct photo *photo, const double box[4], double scale)
{
	int k = (int)fmax(lround(scale), 1);
	int x0 = (int)fmin(fmax(floor(box[0]), 0), photo->width - k), y0 = (int)fmin(fmax(floor(box[1]), 0), photo->height - k);
	int w = ((int)fmin(fmax(ceil(box[2]), x0 + k), photo->width) - x0) / k;
	int h = ((int)fmin(fmax(ceil(box[3]), y0 + k), photo->height) - y0) / k;
	struct log_map m = { w, h, x0, y0, k, mem_array((size_t)w * (size_t)h, sizeof(float[4])) };
	const float norm = 1 / (65535.0f * (float)(k * k));
#pragma omp parallel for schedule(static)
	for (int j = 0; j < h; j++)
		for (int i = 0; i < w; i++) {
			uint32_t sum[3] = { 0 };
			for (int y = y0 + j * k; y < y0 + (j + 1) * k; y++) {
				const uint16_t *p = photo->rgb + 3 * ((size_t)y * (size_t)photo->width + (size_t)(x0 + i * k));
				for (int x = 0; x < k; x++, p += 3)
					for (int c = 0; c < 3; c++)
						sum[c] += p[c];
			}
			float *out = m.px[(size_t)j * (size_t)w + (size_t)i];
			for (int c = 0; c < 3; c++)
				out[c] = logf((float)sum[c] * norm + BLACK);
			out[3] = 0;
		}
	return m;
}

struct log_map log_map_halve(const struct log_map *map)
{
	struct log_map m = { map->width / 2, map->height / 2, map->x0, map->y0, 2 * map->scale, 0 };
	m.px = mem_array((size_t)m.width * (size_t)m.height, sizeof(float[4]));
	for (int j = 0; j < m.height; j++)
		for (int i = 0; i < m.width; i++) {
			const float(*a)[4] = map->px + 2 * (long)j * map->width + 2 * i, (*b)[4] = a + map->width;
			for (int c = 0; c < 4; c++)
				m.px[(long)j * m.width + i][c] = (a[0][c] + a[1][c] + b[0][c] + b[1][c]) / 4;
		}
	return m;
}
