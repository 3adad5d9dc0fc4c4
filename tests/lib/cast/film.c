#include <stdlib.h>
#include <turbojpeg.h>

#include "tests/lib/cast/cast_impl.h"

/* Three box filters along one axis, nearly a Gaussian; width of the boxes 2 r + 1 with r a fraction. */
static void soften(float *p, long n, long step, double r, float *line)
{
	const int whole = (int)r;
	const float part = (float)(r - whole), size = 2 * (float)r + 1;
	for (int pass = 0; pass < 3; pass++) {
		for (long i = 0; i < n; i++)
			line[i] = p[i * step];
		for (long i = 0; i < n; i++) {
			float sum = 0;
			for (long k = i - whole - 1; k <= i + whole + 1; k++)
				sum += (labs(k - i) > whole ? part : 1) * line[k < 0 ? 0 : k >= n ? n - 1 : k];
			p[i * step] = sum / size;
		}
	}
}

static void lens(float *linear, int width, int height, double sigma)
{
	// The variance of a box of width m is (m^2 - 1) / 12 in whole pixels; near enough for a fraction.
	const double r = (sqrt(4 * sigma * sigma + 1) - 1) / 2;
	float *line = malloc(sizeof *line * (size_t)(width > height ? width : height));
	for (int c = 0; c < 3; c++) {
		for (int y = 0; y < height; y++)
			soften(linear + 3L * y * width + c, width, 3, r, line);
		for (int x = 0; x < width; x++)
			soften(linear + 3L * x + c, height, 3L * width, r, line);
	}
	free(line);
}

static double encoded(double v)
{
	return v <= 0.0031308 ? 12.92 * v : 1.055 * pow(v, 1 / 2.4) - 0.055;
}

static void compress(uint8_t *rgb, int width, int height, int quality)
{
	tjhandle to = tjInitCompress(), from = tjInitDecompress();
	unsigned char *bytes = 0;
	unsigned long size = 0;
	if (!tjCompress2(to, rgb, width, 0, height, TJPF_RGB, &bytes, &size, quality > 85 ? TJSAMP_444 : TJSAMP_422, quality, 0))
		tjDecompress2(from, bytes, size, rgb, width, 0, height, TJPF_RGB, 0);
	tjFree(bytes);
	tjDestroy(to);
	tjDestroy(from);
}

double cast_film(uint8_t *rgb, float *linear, int width, int height, const double white[3], struct rng *rng)
{
	const double balanced = rng_below(rng, 3) ? rng_range(rng, 0.7, 1) : rng_range(rng, 0, 0.5), stops = 0.4 * rng_normal(rng) - 0.2;
	const double read = exp(rng_range(rng, log(2e-4), log(6e-3))), shot = exp(rng_range(rng, log(5e-5), log(2e-3)));
	const double curve = rng_below(rng, 10) < 7 ? 0 : rng_range(rng, -0.2, 0.5), sigma = rng_range(rng, 0.3, 1.1), grey = rng_below(rng, 20) ? 0 : 1;
	double gain[3];
	for (int c = 0; c < 3; c++)
		gain[c] = 0.85 * exp2(clamp(stops, -2, 0.8)) / white[1] * pow(white[1] / white[c], balanced);
	lens(linear, width, height, sigma);
	for (long i = 0; i < (long)width * height; i++) {
		double v[3];
		for (int c = 0; c < 3; c++) {
			v[c] = linear[3 * i + c] * gain[c];
			v[c] += rng_normal(rng) * sqrt(read * read + shot * fmax(v[c], 0));
		}
		const double luma = 0.21 * v[0] + 0.72 * v[1] + 0.07 * v[2];
		for (int c = 0; c < 3; c++) {
			double e = encoded(clamp(v[c] + grey * (luma - v[c]), 0, 1));
			e += curve * e * (1 - e) * (2 * e - 1) * 2;
			rgb[3 * i + c] = (uint8_t)lround(255 * clamp(e, 0, 1));
		}
	}
	if (rng_below(rng, 3))
		compress(rgb, width, height, 55 + rng_below(rng, 43));
	return white[0] * gain[0] / (white[2] * gain[2]);
}
