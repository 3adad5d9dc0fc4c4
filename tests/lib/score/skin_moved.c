#include "tests/lib/score/skin_moved.h"

#include <math.h>
#include <stdlib.h>

int skin_how_far(const double now[2], const double was[2])
{
	double d = hypot(now[0] - was[0], now[1] - was[1]);
	int k = 0;
	while (k < SKIN_MOTIONS - 1 && d >= 0.5 * (1 << k))
		k++;
	return k;
}

static int by_error(const void *a, const void *b)
{
	double x = ((const struct skin_moved *)a)->error, y = ((const struct skin_moved *)b)->error;
	return (x > y) - (x < y);
}

double skin_alike(long n, struct skin_moved *point, const double far[SKIN_MOTIONS])
{
	double here[SKIN_MOTIONS] = { 0 }, all = 0, sum = 0;
	for (long i = 0; i < n; i++)
		here[point[i].far]++;
	for (int k = 0; k < SKIN_MOTIONS; k++)
		all += here[k] > 0 ? far[k] : 0;
	qsort(point, (size_t)n, sizeof *point, by_error);
	for (long i = 0; i < n; i++) {
		sum += far[point[i].far] / here[point[i].far];
		if (sum >= 0.5 * all && all > 0)
			return point[i].error;
	}
	return NAN;
}
