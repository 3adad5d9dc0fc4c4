#include "iris/unrefract/rings.h"

#include <math.h>
#include <stdlib.h>

#include "image/plane.h"

double sheet_t(const struct sheet *sheet, double x, double y)
{
	double inner = hypot(x - sheet->pupil.cx, y - sheet->pupil.cy) - sheet->pupil.r;
	double outer = sheet->limbus - hypot(x, y);
	return inner / fmax(inner + outer, 1e-6);
}

void sheet_point(double xy[2], const struct sheet *sheet, double t, double phi)
{
	// The ray of angle phi from the pupil's centre meets both margin and limbus.
	double c = cos(phi), s = sin(phi), cx = sheet->pupil.cx, cy = sheet->pupil.cy;
	double along = cx * c + cy * s, limbus = sheet->limbus;
	double far = -along + sqrt(fmax(along * along - cx * cx - cy * cy + limbus * limbus, 0));
	double r = sheet->pupil.r + t * (far - sheet->pupil.r);
	xy[0] = cx + r * c;
	xy[1] = cy + r * s;
}

float sheet_sample(const float *plane, const struct sheet *sheet, const double xy[2])
{
	const double to = sheet->size / (2 * sheet->extent);
	return plane_sample(plane, sheet->size, sheet->size, (xy[0] + sheet->extent) * to, (xy[1] + sheet->extent) * to);
}

struct weighted {
	float value, weight;
};

static int by_value(const void *a, const void *b)
{
	float x = ((const struct weighted *)a)->value, y = ((const struct weighted *)b)->value;
	return (x > y) - (x < y);
}

static float quantile(const struct weighted *v, int n, double total, double q)
{
	double sum = 0;
	for (int i = 0; i < n; i++) {
		sum += v[i].weight;
		if (sum >= q * total)
			return v[i].value;
	}
	return n ? v[n - 1].value : NAN;
}

/* Rings of which nothing was seen take their neighbour's values. */
static void fill_gaps(float *v, int n)
{
	for (int i = 1; i < n; i++)
		if (!isfinite(v[i]))
			v[i] = v[i - 1];
	for (int i = n - 2; i >= 0; i--)
		if (!isfinite(v[i]))
			v[i] = v[i + 1];
}

struct rings rings_of(const float *plane, const float *weight, const struct sheet *sheet, bool favour,
                      float min_scale)
{
	struct rings rings;
	for (int ring = 0; ring < SHEET_RINGS; ring++) {
		struct weighted v[SHEET_ANGLES];
		double total = 0;
		int n = 0;
		for (int a = 0; a < SHEET_ANGLES; a++) {
			double phi = 2 * M_PI * (a + 0.5) / SHEET_ANGLES, p[2], c = cos(phi);
			sheet_point(p, sheet, (ring + 0.5) / SHEET_RINGS, phi);
			double to = sheet->size / (2 * sheet->extent);
			double x = (p[0] + sheet->extent) * to, y = (p[1] + sheet->extent) * to;
			float w = plane_sample(weight, sheet->size, sheet->size, x, y) * (float)(favour ? 0.2 + (sheet->open ? 0.5 * c * c + sheet->open[a] : c * c) : 1);
			if (w < 0.1f)
				continue;
			v[n++] = (struct weighted){ plane_sample(plane, sheet->size, sheet->size, x, y), w };
			total += w;
		}
		qsort(v, (size_t)n, sizeof *v, by_value);
		rings.median[ring] = n < SHEET_ANGLES / 20 ? NAN : quantile(v, n, total, 0.5);
		// quartiles are 1.349 standard deviations apart
		float spread = (quantile(v, n, total, 0.75) - quantile(v, n, total, 0.25)) / 1.349f;
		rings.scale[ring] = n < SHEET_ANGLES / 20 ? NAN : fmaxf(spread, min_scale);
	}
	fill_gaps(rings.median, SHEET_RINGS);
	fill_gaps(rings.scale, SHEET_RINGS);
	return rings;
}

void rings_even(struct rings *rings)
{
	float sorted[SHEET_RINGS];
	for (int i = 0; i < SHEET_RINGS; i++) {
		int k = i;
		for (; k > 0 && sorted[k - 1] > rings->scale[i]; k--)
			sorted[k] = sorted[k - 1];
		sorted[k] = rings->scale[i];
	}
	for (int i = 0; i < SHEET_RINGS; i++)
		rings->scale[i] = fminf(rings->scale[i], 1.2f * sorted[SHEET_RINGS / 2]);
}

static float between(const float v[SHEET_RINGS], double t)
{
	double at = fmin(fmax(t * SHEET_RINGS - 0.5, 0), SHEET_RINGS - 1.001);
	int i = (int)at;
	float f = (float)at - (float)i;
	return (1 - f) * v[i] + f * v[i + 1];
}

float rings_median(const struct rings *rings, double t)
{
	return between(rings->median, t);
}

float rings_z(const struct rings *rings, float value, double t)
{
	return (value - between(rings->median, t)) / between(rings->scale, t);
}
