#include "tests/lib/variants/bent.h"

#include <math.h>

void bent_pixel(double bent[2], const struct camera *lens, const double straight[2])
{
	const double *k = lens->distortion, f = lens->focal_px;
	double x = (straight[0] - lens->center_px[0]) / f, y = (straight[1] - lens->center_px[1]) / f, r2 = x * x + y * y;
	double radial = 1 + k[0] * r2 + k[1] * r2 * r2 + k[4] * r2 * r2 * r2;
	bent[0] = lens->center_px[0] + f * (x * radial + 2 * k[2] * x * y + k[3] * (r2 + 2 * x * x));
	bent[1] = lens->center_px[1] + f * (y * radial + k[2] * (r2 + 2 * y * y) + 2 * k[3] * x * y);
}

void bent_straight(double straight[2], const struct camera *lens, const double bent[2])
{
	straight[0] = bent[0];
	straight[1] = bent[1];
	double at[2];
	bent_pixel(at, lens, straight);
	for (int i = 0; i < 60 && fabs(bent[0] - at[0]) + fabs(bent[1] - at[1]) > 1e-10; i++) {
		straight[0] += bent[0] - at[0];
		straight[1] += bent[1] - at[1];
		bent_pixel(at, lens, straight);
	}
}

/* Keys 1981, a = -1/2. */
static void weights(double w[4], double t)
{
	w[0] = 0.5 * t * (t * (2 - t) - 1);
	w[1] = 0.5 * (t * t * (3 * t - 5) + 2);
	w[2] = 0.5 * t * (t * (4 - 3 * t) + 1);
	w[3] = 0.5 * t * t * (t - 1);
}

static int clamp(int i, int n)
{
	return i < 0 ? 0 : i >= n ? n - 1 : i;
}

/* Columns, rows and weights of the sixteen pixels round the place that is seen at (x, y). */
static void taps(int col[4], int row[4], double wx[4], double wy[4], int x, int y, int width, int height, const struct camera *lens)
{
	double p[2], fx, fy;
	bent_straight(p, lens, (double[]){ x + 0.5, y + 0.5 });
	p[0] = fmin(fmax(p[0] - 0.5, -1), width);
	p[1] = fmin(fmax(p[1] - 0.5, -1), height);
	fx = floor(p[0]);
	fy = floor(p[1]);
	weights(wx, p[0] - fx);
	weights(wy, p[1] - fy);
	for (int i = 0; i < 4; i++) {
		col[i] = clamp((int)fx + i - 1, width);
		row[i] = clamp((int)fy + i - 1, height);
	}
}

#define BEND(type, most) \
	for (int y = 0; y < height; y++) \
		for (int x = 0; x < width; x++) { \
			int col[4], row[4]; \
			double wx[4], wy[4]; \
			taps(col, row, wx, wy, x, y, width, height, lens); \
			for (int c = 0; c < 3; c++) { \
				double sum = 0; \
				for (int j = 0; j < 4; j++) \
					for (int i = 0; i < 4; i++) \
						sum += wx[i] * wy[j] * in[3 * ((long)row[j] * width + col[i]) + c]; \
				out[3 * ((long)y * width + x) + c] = (type)lround(fmin(fmax(sum, 0), most)); \
			} \
		}

void bent_rgb16(uint16_t *out, const uint16_t *in, int width, int height, const struct camera *lens)
{
#pragma omp parallel for
	BEND(uint16_t, 65535)
}

void bent_rgb8(uint8_t *out, const uint8_t *in, int width, int height, const struct camera *lens)
{
#pragma omp parallel for
	BEND(uint8_t, 255)
}
