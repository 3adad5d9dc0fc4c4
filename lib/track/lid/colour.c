#include "track/lid/colour.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"

int lid_colour_bin(const uint8_t rgb[3])
{
	int r = rgb[0], g = rgb[1], b = rgb[2], light = r + 2 * g + b;
	// log2 of 32 .. 1052 by the exponent and the next two bits.
	int v = light + 32, e = 31 - __builtin_clz((unsigned)v), l = (e - 5) * 3 + (((v >> (e - 2)) & 3) * 3) / 4;
	int red = 8 + (r - g) * 90 / (light + 64), blue = 6 + (g - b) * 70 / (light + 64);
	l = l < 0 ? 0 : l >= LID_LIGHT ? LID_LIGHT - 1 : l;
	red = red < 0 ? 0 : red >= LID_RED ? LID_RED - 1 : red;
	blue = blue < 0 ? 0 : blue >= LID_BLUE ? LID_BLUE - 1 : blue;
	return (l * LID_RED + red) * LID_BLUE + blue;
}

/* Zone of the eye: rings of the iris, then sclera towards the nose and away from it; the last zone, all of it, where the iris is
 * unknown. */
static int ring_of(const struct lid_iris *iris, double cols, double rows)
{
	static const double outer[] = { 0.4, 0.6, 0.8, 1.04 };
	double u = (cols - iris->col) / iris->cols, v = (rows - iris->row) / iris->rows, r2 = u * u + v * v;
	if (!(iris->cols > 0) || !(iris->rows > 0))
		return LID_ZONES - 1;
	for (int k = 0; k < COUNT(outer); k++)
		if (r2 < outer[k] * outer[k])
			return LID_THIRDS + k;
	return LID_THIRDS + COUNT(outer) + (u > 0);
}

void lid_colour_learn(struct lid_colour *colour, const struct lid_chart *chart, const double upper[],
                      const double lower[], const struct lid_iris *iris, const double clear[2], double band,
                      double keep)
{
	float *all = &colour->seen[0][0];
	for (int i = 0; i < LID_ZONES * LID_BINS; i++)
		all[i] *= (float)keep;
	colour->frames = colour->frames * keep + 1;
	for (int i = 0; i < chart->cols; i++) {
		for (int j = 0; j < LID_ROWS; j++) {
			bool eye = j > upper[i] + clear[1] && j < lower[i] - clear[1];
			bool lid = (j < upper[i] - clear[0] && j > upper[i] - band)
			           || (j > lower[i] + clear[0] && j < lower[i] + band);
			if (lower[i] <= upper[i])
				lid = fabs(j - 0.5 * (upper[i] + lower[i])) < band, eye = false;
			if (!eye && !lid)
				continue;
			int bin = lid_colour_bin(chart->rgb[j][i]), zone = eye ? ring_of(iris, i, j) : i * LID_THIRDS / chart->cols;
			colour->seen[zone][bin]++;
			if (eye && zone != LID_ZONES - 1)
				colour->seen[LID_ZONES - 1][bin]++;
		}
	}
}

/* [1 2 1] / 4 along one of the three directions. */
static void blur(float *x, int count, int stride, int inner)
{
	for (int o = 0; o < LID_BINS / (count * stride); o++) {
		for (int i = 0; i < inner; i++) {
			float *p = x + (long)o * count * stride + i, before = p[0];
			for (int k = 0; k < count; k++) {
				float here = p[k * stride], after = k + 1 < count ? p[(k + 1) * stride] : here;
				p[k * stride] = 0.25f * before + 0.5f * here + 0.25f * after;
				before = here;
			}
		}
	}
}

void lid_colour_log(float says[LID_BINS], const float seen[LID_BINS])
{
	double sum = 1;
	memcpy(says, seen, LID_BINS * sizeof *says);
	blur(says, LID_LIGHT, LID_RED * LID_BLUE, LID_RED * LID_BLUE);
	blur(says, LID_RED, LID_BLUE, LID_BLUE);
	blur(says, LID_BLUE, 1, 1);
	for (int i = 0; i < LID_BINS; i++)
		sum += (double)says[i];
	// A floor: colours hardly ever seen are no evidence.
	const double rare = 2e-4;
	for (int i = 0; i < LID_BINS; i++)
		says[i] = (float)log((double)says[i] / sum + rare);
}

void lid_colour_settle(struct lid_colour *colour)
{
	for (int z = 0; z < LID_ZONES; z++)
		lid_colour_log(colour->says[z], colour->seen[z]);
}

void lid_colour_ask(float odds[LID_ROWS][LID_COLS_MAX], const struct lid_colour *colour, const struct lid_chart *chart,
                    const struct lid_iris *iris)
{
	for (int j = 0; j < LID_ROWS; j++)
		for (int i = 0; i < chart->cols; i++) {
			int bin = lid_colour_bin(chart->rgb[j][i]);
			float says = colour->says[ring_of(iris, i, j)][bin] - colour->says[i * LID_THIRDS / chart->cols][bin];
			odds[j][i] = fmaxf(-LID_SURE, fminf(LID_SURE, says));
		}
}
