#include "tests/lib/score/likeness.h"

#include <math.h>

#include "bridge/cv_blur.h"

enum { A, B, AA, BB, AB, NOISE, MOMENTS };
static const double window = 1.5, k1 = 0.01, k2 = 0.03;

static double coded(const float *p, double gain)
{
	const double light = fmin(fmax(gain * (0.2126 * (double)p[0] + 0.7152 * (double)p[1] + 0.0722 * (double)p[2]), 0), 1);
	return light <= 0.0031308 ? 12.92 * light : 1.055 * pow(light, 1 / 2.4) - 0.055;
}

double likeness_structure(const struct image *a, const struct image *b, const struct image *const half[2], double gain)
{
	struct image of[MOMENTS], mean[MOMENTS];
	struct err err = { 0 };
	const int n = a->width * a->height;
	double sum = 0;
	long count = 0;
	for (int k = 0; k < MOMENTS; k++) {
		of[k] = image_new(a->width, a->height, 1);
		mean[k] = image_new(a->width, a->height, 1);
	}
	for (int i = 0; i < n; i++) {
		const double x = coded(a->px + 4L * i, gain), y = coded(b->px + 4L * i, gain);
		// Half the halves' difference has the variance of their mean's noise.
		const double noise = half ? (coded(half[0]->px + 4L * i, gain) - coded(half[1]->px + 4L * i, gain)) / 2 : 0;
		const double moment[MOMENTS] = { x, y, x * x, y * y, x * y, noise * noise };
		for (int k = 0; k < MOMENTS; k++)
			of[k].px[i] = (float)moment[k];
	}
	for (int k = 0; k < MOMENTS; k++)
		cv_blur(mean[k].px, of[k].px, a->width, a->height, 1, window, &err);
	for (int i = 0; i < n; i++) {
		if (a->px[4L * i + 3] < 1 || b->px[4L * i + 3] < 1)
			continue;
		const double x = (double)mean[A].px[i], y = (double)mean[B].px[i], xx = (double)mean[AA].px[i] - x * x, yy = (double)mean[BB].px[i] - (double)mean[NOISE].px[i] - y * y, xy = (double)mean[AB].px[i] - x * y;
		sum += (2 * x * y + k1 * k1) * (2 * xy + k2 * k2) / ((x * x + y * y + k1 * k1) * (xx + yy + k2 * k2));
		count++;
	}
	for (int k = 0; k < MOMENTS; k++) {
		image_free(&of[k]);
		image_free(&mean[k]);
	}
	return count ? sum / (double)count : 0;
}

static bool covers(const struct image *m, int x, int y)
{
	return x >= 0 && y >= 0 && x < m->width && y < m->height && image_at(m, x, y)[3] >= 0.5f;
}

double likeness_outline(const struct image *a, const struct image *b)
{
	long apart = 0, edges = 0;
	for (int y = 0; y < a->height; y++)
		for (int x = 0; x < a->width; x++) {
			const bool in = covers(a, x, y);
			apart += in != covers(b, x, y);
			// Sides of pixels: a slanted outline is by 4 / pi longer so than it is, on average over its directions.
			edges += in && x + 1 < a->width && !covers(a, x + 1, y);
			edges += in && x > 0 && !covers(a, x - 1, y);
			edges += in && y + 1 < a->height && !covers(a, x, y + 1);
			edges += in && y > 0 && !covers(a, x, y - 1);
		}
	return edges ? (double)apart / ((double)edges * M_PI / 4) : 0;
}
