#include "image/image.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"

struct image image_new(int width, int height, int channels)
{
	size_t n = (size_t)width * (size_t)height * (size_t)channels;
	struct image image = { width, height, channels, mem_array(n, sizeof(float)) };
	memset(image.px, 0, n * sizeof(float));
	return image;
}

void image_free(struct image *image)
{
	free(image->px);
	*image = (struct image){ 0 };
}

static int clamp_int(int x, int lo, int hi)
{
	return x < lo ? lo : x > hi ? hi : x;
}

float image_sample(const struct image *image, double x, double y, int channel)
{
	double fx = floor(x - 0.5), fy = floor(y - 0.5);
	float tx = (float)(x - 0.5 - fx), ty = (float)(y - 0.5 - fy);
	int x0 = clamp_int((int)fx, 0, image->width - 1), x1 = clamp_int((int)fx + 1, 0, image->width - 1);
	int y0 = clamp_int((int)fy, 0, image->height - 1), y1 = clamp_int((int)fy + 1, 0, image->height - 1);
	float a = image_at(image, x0, y0)[channel], b = image_at(image, x1, y0)[channel];
	float c = image_at(image, x0, y1)[channel], d = image_at(image, x1, y1)[channel];
	return (1 - ty) * ((1 - tx) * a + tx * b) + ty * ((1 - tx) * c + tx * d);
}

float srgb_from_linear(float x)
{
	return x <= 0.0031308f ? 12.92f * x : 1.055f * powf(x, 1 / 2.4f) - 0.055f;
}

float linear_from_srgb(float x)
{
	return x <= 0.04045f ? x / 12.92f : powf((x + 0.055f) / 1.055f, 2.4f);
}

uint8_t *image_to_srgb8(const struct image *image)
{
	// 4096 steps of linear value are too coarse in the darks; a table of 2^14 is good to half an 8-bit step.
	enum { STEPS = 1 << 14 };
	uint8_t *table = mem_array(STEPS + 1, 1);
	for (int i = 0; i <= STEPS; i++)
		table[i] = (uint8_t)lrintf(255 * srgb_from_linear((float)i / STEPS));
	long n = (long)image->width * image->height * image->channels;
	uint8_t *out = mem_array((size_t)n, 1);
	for (long i = 0; i < n; i++) {
		float v = image->px[i];
		v = v > 0 ? v < 1 ? v : 1 : 0;  // NaN becomes 0
		out[i] = table[(int)(v * STEPS + 0.5f)];
	}
	free(table);
	return out;
}
