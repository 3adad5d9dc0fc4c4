#include "skin/lid_colour.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"

/* Brightness on a logarithmic scale, and two differences of colour over brightness: light that falls off moves the first
 * alone. */
static int bin_of(const uint8_t rgb[3])
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

void lid_colour_learn(struct lid_colour *colour, const struct lid_chart *chart, const double upper[],
                      const double lower[], const double clear[2], double band, double keep)
{
	float *all = &colour->seen[0][0][0];
	for (int i = 0; i < LID_ZONES * 2 * LID_BINS; i++)
		all[i] *= (float)keep;
	colour->frames = colour->frames * keep + 1;
	for (int i = 0; i < chart->cols; i++) {
		for (int j = 0; j < LID_ROWS; j++) {
			bool eye = j > upper[i] + clear[1] && j < lower[i] - clear[1];
			bool lid = (j < upper[i] - clear[0] && j > upper[i] - band)
			           || (j > lower[i] + clear[0] && j < lower[i] + band);
			if (lower[i] <= upper[i])
				lid = fabs(j - 0.5 * (upper[i] + lower[i])) < band, eye = false;
			if (eye || lid)
				colour->seen[i * LID_ZONES / chart->cols][eye][bin_of(chart->rgb[j][i])]++;
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

static void settle_zone(float says[LID_BINS], float seen[2][LID_BINS])
{
	float *part[2];
	double sum[2] = { 1, 1 };
	for (int k = 0; k < 2; k++) {
		part[k] = mem_array(LID_BINS, sizeof *part[k]);
		memcpy(part[k], seen[k], LID_BINS * sizeof *part[k]);
		blur(part[k], LID_LIGHT, LID_RED * LID_BLUE, LID_RED * LID_BLUE);
		blur(part[k], LID_RED, LID_BLUE, LID_BLUE);
		blur(part[k], LID_BLUE, 1, 1);
		for (int i = 0; i < LID_BINS; i++)
			sum[k] += part[k][i];
	}
	// What was hardly ever seen says nothing.
	const double rare = 2e-4;
	for (int i = 0; i < LID_BINS; i++) {
		double odds = log((part[1][i] / sum[1] + rare) / (part[0][i] / sum[0] + rare));
		says[i] = (float)fmax(-LID_SURE, fmin(LID_SURE, odds));
	}
	free(part[0]);
	free(part[1]);
}

void lid_colour_settle(struct lid_colour *colour)
{
	for (int z = 0; z < LID_ZONES; z++)
		settle_zone(colour->says[z], colour->seen[z]);
}

void lid_colour_ask(float odds[LID_ROWS][LID_COLS_MAX], const struct lid_colour *colour, const struct lid_chart *chart)
{
	for (int j = 0; j < LID_ROWS; j++)
		for (int i = 0; i < chart->cols; i++)
			odds[j][i] = colour->says[i * LID_ZONES / chart->cols][bin_of(chart->rgb[j][i])];
}
