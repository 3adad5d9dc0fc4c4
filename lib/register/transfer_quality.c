#include "register/transfer_quality.h"

#include <stdlib.h>

#include "base/mem.h"
#include "math/stats.h"

int transfer_trusted(const struct transfer *t)
{
	int n = 0;
	for (int i = 0; i < t->n; i++)
		n += t->confidence[i] > TRANSFER_TRUSTED;
	return n;
}

double transfer_distance(const struct transfer *t, double q)
{
	double *d = mem_array((size_t)t->n + 1, sizeof *d);
	int n = 0;
	for (int i = 0; i < t->n; i++)
		if (t->confidence[i] > TRANSFER_TRUSTED)
			d[n++] = (double)t->distance[i];
	double at = stats_quantile(n, d, q);
	free(d);
	return at;
}
