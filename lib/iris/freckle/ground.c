#include "iris/freckle/ground.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"

enum { SECTORS = GROUND_SECTORS, RINGS = GROUND_RINGS, BINS = 192 };

typedef int histogram[BINS];

static void count(histogram (*h)[RINGS], const float *plane, const uint8_t *use, const struct sheet *sheet, float lo,
                  float hi)
{
	double mm = 2 * sheet->extent / sheet->size;
	for (int row = 0; row < sheet->size; row += 2)
		for (int col = 0; col < sheet->size; col += 2) {
			long i = (long)row * sheet->size + col;
			if (!use[i])
				continue;
			double x = (col + 0.5) * mm - sheet->extent, y = (row + 0.5) * mm - sheet->extent;
			double phi = atan2(y - sheet->pupil.cy, x - sheet->pupil.cx) / (2 * M_PI) + 1;
			int ring = (int)(sheet_t(sheet, x, y) * RINGS), bin = (int)((plane[i] - lo) / (hi - lo) * BINS);
			if (ring < 0 || ring >= RINGS)
				continue;
			h[(int)(phi * SECTORS) % SECTORS][ring][bin < 0 ? 0 : bin >= BINS ? BINS - 1 : bin]++;
		}
}

static float quantile(const int *h, long total, double q, float lo, float hi)
{
	double want = q * (double)total, sum = 0;
	for (int b = 0; b < BINS; b++) {
		if (sum + h[b] >= want && h[b])
			return lo + (hi - lo) * (float)((b + (want - sum) / h[b]) / BINS);
		sum += h[b];
	}
	return hi;
}

static void window(struct ground *g, histogram (*h)[RINGS], int s, int r, float lo, float hi)
{
	const long enough = 40;
	int sum[BINS] = { 0 };
	long total = 0;
	for (int ds = -1; ds <= 1; ds++)
		for (int k = r > 0 ? r - 1 : 0; k <= r + 1 && k < RINGS; k++)
			for (int b = 0; b < BINS; b++)
				sum[b] += h[(s + ds + SECTORS) % SECTORS][k][b];
	for (int b = 0; b < BINS; b++)
		total += sum[b];
	g->median[s][r] = total < enough ? NAN : quantile(sum, total, 0.5, lo, hi);
	g->spread[s][r] = total < enough ? NAN
	                                 : (quantile(sum, total, 0.75, lo, hi) - quantile(sum, total, 0.25, lo, hi)) / 1.349f;
}

/* Windows of which too little was seen take the values of the nearest sector in their ring, or of the ring within. */
static void fill_gaps(float (*v)[RINGS])
{
	for (int r = 0; r < RINGS; r++) {
		float ring[SECTORS];
		for (int s = 0; s < SECTORS; s++) {
			ring[s] = v[s][r];
			for (int d = 1; d <= SECTORS / 2 && !isfinite(ring[s]); d++)
				ring[s] = isfinite(v[(s + d) % SECTORS][r]) ? v[(s + d) % SECTORS][r] : v[(s - d + SECTORS) % SECTORS][r];
		}
		for (int s = 0; s < SECTORS; s++)
			v[s][r] = isfinite(ring[s]) ? ring[s] : r ? v[s][r - 1] : 0;
	}
}

struct ground *ground_new(const float *plane, const uint8_t *use, const struct sheet *sheet, float lo, float hi)
{
	histogram(*h)[RINGS] = mem_new(SECTORS, sizeof *h);
	struct ground *g = mem_new(1, sizeof *g);
	count(h, plane, use, sheet, lo, hi);
	for (int s = 0; s < SECTORS; s++)
		for (int r = 0; r < RINGS; r++)
			window(g, h, s, r, lo, hi);
	fill_gaps(g->median);
	fill_gaps(g->spread);
	free(h);
	return g;
}

void ground_at(float *median, float *spread, const struct ground *g, double t, double phi)
{
	double s = (phi / (2 * M_PI) + 2) * SECTORS - 0.5, r = fmin(fmax(t * RINGS - 0.5, 0), RINGS - 1.001);
	int s0 = (int)s % SECTORS, s1 = (s0 + 1) % SECTORS, r0 = (int)r;
	float fs = (float)(s - floor(s)), fr = (float)(r - r0);
	float a = (1 - fs) * (1 - fr), b = fs * (1 - fr), c = (1 - fs) * fr, d = fs * fr;
	*median = a * g->median[s0][r0] + b * g->median[s1][r0] + c * g->median[s0][r0 + 1] + d * g->median[s1][r0 + 1];
	*spread = a * g->spread[s0][r0] + b * g->spread[s1][r0] + c * g->spread[s0][r0 + 1] + d * g->spread[s1][r0 + 1];
}
