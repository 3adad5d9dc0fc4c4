#include "draw/web/field.h"

#include <math.h>
#include <stdlib.h>

#include "base/mem.h"

/* 2^-16 mm, or as fine as 31 bits hold the largest. */
static double step_of(const float *px, long n)
{
	double most = 0;
	for (long i = 0; i < n; i++)
		most = fmax(most, fabs((double)px[i]));
	int bits = most > 0 && isfinite(most) ? ilogb(most) + 1 : 0;
	return ldexp(1, bits > 14 ? bits - 30 : -16);
}

/* Seven bits a byte, the lowest first, the eighth set where more follow (LEB128); the sign in the lowest bit (zigzag), so that
 * small numbers are short. */
static long put(uint8_t *to, uint32_t residual)
{
	uint32_t v = residual << 1 ^ (residual >> 31 ? 0xffffffffu : 0);
	long n = 0;
	for (; v > 127; v >>= 7)
		to[n++] = (uint8_t)(v | 128);
	to[n++] = (uint8_t)v;
	return n;
}

uint8_t *field_encode(size_t *size, double *unit, const float *px, int width, int height, int channels)
{
	long row = (long)width * channels, n = row * height, used = 0;
	double step = *unit = step_of(px, n);
	uint32_t *whole = mem_new((size_t)row * 2 + 1, sizeof *whole);  // this row and the one above, each modulo 2^32
	uint8_t *bytes = mem_array((size_t)n * 5 + 1, 1);
	for (int y = 0; y < height; y++) {
		uint32_t *now = whole + y % 2 * row, *above = whole + (y + 1) % 2 * row;
		for (long i = 0; i < row; i++) {
			double v = (double)px[y * row + i] / step;
			uint32_t left = i < channels ? 0 : now[i - channels], corner = i < channels ? 0 : above[i - channels];
			now[i] = isfinite(v) ? (uint32_t)lrint(v) : 0;
			used += put(bytes + used, now[i] - left - above[i] + corner);
		}
	}
	free(whole);
	*size = (size_t)used;
	return bytes;
}
