#include "draw/studio.h"

#include <math.h>

#include "draw/bloom.h"
#include "draw/tone.h"

double studio_exposure(const struct envmap *env, const double sclera[3])
{
	enum { TURNS = 16 };
	double mean = 0, most = 0;
	for (int k = 0; k < TURNS; k++) {
		double turn = 2 * M_PI * k / TURNS;
		float light[3], n[3] = { (float)(0.7071 * cos(turn)), (float)(0.7071 * sin(turn)), -0.7071f };
		envmap_irradiance(light, env, n);
		double lum = 0.2126 * sclera[0] * light[0] + 0.7152 * sclera[1] * light[1] + 0.0722 * sclera[2] * light[2];
		mean += lum / TURNS;
		most = fmax(most, lum);
	}
	return fmin(fmax(0.62 * 2 / (mean + most), 0.05), 3);
}

struct image studio_on_grey(const struct image *rgba, double gain, const struct studio_finish *finish)
{
	// A photographer's grey, falling off towards the corners.
	static const float middle = 0.115f, corner = 0.030f;
	struct image out = image_new(rgba->width, rgba->height, 3);
#pragma omp parallel for schedule(static)
	for (int y = 0; y < out.height; y++)
		for (int x = 0; x < out.width; x++) {
			float u = 2 * ((float)x + 0.5f) / (float)out.width - 1, v = 2 * ((float)y + 0.5f) / (float)out.height - 1;
			float t = fminf((u * u + v * v) / 2, 1), grey = middle + t * (corner - middle);
			const float *p = image_at(rgba, x, y);
			for (int c = 0; c < 3; c++)
				image_at(&out, x, y)[c] = p[c] * (float)gain + (1 - p[3]) * grey;
		}
	bloom(&out, finish->bloom);
	tone(&out, finish->tone);
	return out;
}
