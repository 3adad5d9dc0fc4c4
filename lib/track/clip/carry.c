#include "track/clip/carry.h"

#include <math.h>

enum { APART = 16, REACH = 20, AREA_WIDE = CARRY_WIDE + 2 * REACH, AREA_HIGH = CARRY_HIGH + 2 * REACH, FINEST = 4, LEAST_PIXELS = 300 };
static const double LOWER = 0.3;     // eyes' distances: the middle of what is compared below the eyes, where the nose is
static const double ALIKE = 0.75;    // correlation of a face with itself a frame later, at least
static const double FAR = 0.1;       // so much less likely, in correlation, is what lies at the end of the reach

/* The mean of a large pixel; NAN: most of it is outside of the picture. */
static float pixel(const uint8_t *luma, int stride, int width, int height, double x, double y, double unit)
{
	const int fine = (int)fmin(fmax(ceil(unit), 1), FINEST);
	int sum = 0, n = 0;
	for (int j = 0; j < fine; j++)
		for (int i = 0; i < fine; i++) {
			const double u = floor(x + ((i + 0.5) / fine - 0.5) * unit), v = floor(y + ((j + 0.5) / fine - 0.5) * unit);
			if (u >= 0 && v >= 0 && u < width && v < height) {
				sum += luma[(long)v * stride + (long)u];
				n++;
			}
		}
	return 2 * n < fine * fine ? NAN : (float)sum / (float)n;
}

static void look(float *out, int wide, int high, const uint8_t *luma, int stride, int width, int height, const double middle[2], double apart)
{
	const double unit = apart / APART;
	for (int j = 0; j < high; j++)
		for (int i = 0; i < wide; i++)
			out[j * wide + i] = pixel(luma, stride, width, height, middle[0] + (i + 0.5 - 0.5 * wide) * unit, middle[1] + LOWER * apart + (j + 0.5 - 0.5 * high) * unit, unit);
}

void carry_keep(struct carry *c, const uint8_t *luma, int stride, int width, int height, const double middle[2], double apart)
{
	c->known = apart > 1 && isfinite(middle[0] + middle[1]);
	if (!c->known)
		return;
	c->apart = apart;
	for (int k = 0; k < 2; k++)
		c->middle[k] = middle[k];
	look(c->patch[0], CARRY_WIDE, CARRY_HIGH, luma, stride, width, height, middle, apart);
}

/* Correlation with the area from (x, y) on; -1 where too little of both is in the picture. */
static double alike(const struct carry *c, const float *area, int x, int y)
{
	float a = 0, b = 0, aa = 0, bb = 0, ab = 0, n = 0;
	for (int j = 0; j < CARRY_HIGH; j++) {
		const float *row = area + (y + j) * AREA_WIDE + x;
		for (int i = 0; i < CARRY_WIDE; i++) {
			const float in = isnan(c->patch[j][i] + row[i]) ? 0.0F : 1.0F, p = in > 0 ? c->patch[j][i] - 128 : 0, q = in > 0 ? row[i] - 128 : 0;
			a += p;
			b += q;
			aa += p * p;
			bb += q * q;
			ab += p * q;
			n += in;
		}
	}
	const double va = (double)(aa - a * a / n), vb = (double)(bb - b * b / n);
	return n < LEAST_PIXELS || va < (double)n || vb < (double)n ? -1 : (double)(ab - a * b / n) / sqrt(va * vb);
}

/* Where a parabola through three values has its top, in steps from the middle one. */
static double top(double before, double at, double after)
{
	const double bend = before - 2 * at + after;
	return bend < 0 ? fmin(fmax(0.5 * (before - after) / bend, -0.5), 0.5) : 0;
}

bool carry_find(double shift[2], const struct carry *c, const uint8_t *luma, int stride, int width, int height)
{
	enum { SIDE = 2 * REACH + 1 };
	float area[AREA_HIGH * AREA_WIDE];
	double score[SIDE][SIDE];
	int best[2] = { REACH, REACH };
	if (!c->known)
		return false;
	look(area, AREA_WIDE, AREA_HIGH, luma, stride, width, height, c->middle, c->apart);
#pragma omp parallel for
	for (int y = 0; y < SIDE; y++)
		for (int x = 0; x < SIDE; x++)
			score[y][x] = alike(c, area, x, y) - FAR * ((x - REACH) * (x - REACH) + (y - REACH) * (y - REACH)) / (REACH * REACH);
	for (int y = 0; y < SIDE; y++)
		for (int x = 0; x < SIDE; x++)
			if (score[y][x] > score[best[1]][best[0]]) {
				best[0] = x;
				best[1] = y;
			}
	const int x = best[0], y = best[1];
	if (score[y][x] < ALIKE || x == 0 || y == 0 || x == SIDE - 1 || y == SIDE - 1)
		return false;
	shift[0] = (x - REACH + top(score[y][x - 1], score[y][x], score[y][x + 1])) * c->apart / APART;
	shift[1] = (y - REACH + top(score[y - 1][x], score[y][x], score[y + 1][x])) * c->apart / APART;
	return true;
}
