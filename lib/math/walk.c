#include "math/walk.h"

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
