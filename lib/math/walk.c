#include "math/walk.h"

#include <math.h>

#include "math/stats.h"

void walk_smooth(long n, double *x, const double *sigma, double step, double *room)
{
	double tie = 1 / (step * step), *up = room;
	for (long i = 0; i < n; i++) {
		double w = 1 / (sigma[i] * sigma[i]), d = w + (i > 0 ? tie : 0) + (i + 1 < n ? tie : 0), b = w * x[i];
		if (i) {
			d -= tie * up[i - 1];
			b += tie * x[i - 1];
		}
		up[i] = tie / d;
		x[i] = b / d;
	}
	for (long i = n - 2; i >= 0; i--)
		x[i] += up[i] * x[i + 1];
}

void walk_glide(long n, double *x, const double *sigma, double bend, double *room)
{
	const double tie = 1 / (bend * bend), second[3] = { 1, -2, 1 };
	double *near = room, *far = room + n, d1 = 0, d2 = 0;  // of the two rows before: pivots
	for (long i = 0; i < n; i++) {
		// second differences that begin at j, j = i - 2 .. i, see x[i] with weight second[i - j]
		double a = 0, b = 0, c = 0, w = 1 / (sigma[i] * sigma[i]);
		for (long j = i > 2 ? i - 2 : 0; j <= i && j + 2 < n; j++) {
			const long k = i - j;
			a += tie * second[k] * second[k];
			b += k < 2 ? tie * second[k] * second[k + 1] : 0;
			c += k < 1 ? tie * second[k] * second[k + 2] : 0;
		}
		const double n1 = i > 0 ? near[i - 1] : 0, f2 = i > 1 ? far[i - 2] : 0, f1 = i > 0 ? far[i - 1] : 0;
		const double pivot = a + w - n1 * n1 * d1 - f2 * f2 * d2;
		x[i] = w * x[i] - (i > 0 ? n1 * d1 * x[i - 1] : 0) - (i > 1 ? f2 * d2 * x[i - 2] : 0);
		near[i] = (b - n1 * d1 * f1) / pivot;
		far[i] = c / pivot;
		x[i] /= pivot;
		d2 = d1;
		d1 = pivot;
	}
	for (long i = n - 2; i >= 0; i--)
		x[i] -= near[i] * x[i + 1] + (i + 2 < n ? far[i] * x[i + 2] : 0);
}

void walk_unrest(double *noise, double *bend, long n, const double *x, double *room)
{
	const double normal = 1.4826;
	double at[2];
	for (int order = 2; order < 4; order++) {
		int m = 0;
		for (long f = 0; f + order < n; f++) {
			const double d = order == 2 ? x[f] - 2 * x[f + 1] + x[f + 2] : x[f] - 3 * x[f + 1] + 3 * x[f + 2] - x[f + 3];
			if (!isnan(d))
				room[m++] = fabs(d);
		}
		at[order - 2] = m ? normal * stats_median(m, room) : 0;
	}
	*noise = at[1] / sqrt(20);
	*bend = at[0];
}
