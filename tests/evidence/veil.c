#include "veil.h"

#include <math.h>
#include <stdlib.h>

#include "base/mem.h"
#include "math/stats.h"

struct veil veil_of(const struct drawn *d, double x, double y, double radius)
{
	const long n = (long)d->width * d->height;
	double *mirror = mem_array((size_t)n, sizeof *mirror), *iris = mem_array((size_t)n, sizeof *iris);
	int all = 0, irises = 0;
	for (long i = 0; i < n && d->mirror; i++) {
		if (d->label[i] < EVIDENCE_IRIS || hypot((double)(i % d->width) - x, (double)(i / d->width) - y) > radius)
			continue;
		mirror[all++] = (double)d->mirror[i];
		if (d->label[i] == EVIDENCE_IRIS)
			iris[irises++] = (double)d->body[i];
	}
	struct veil v = { all ? (float)stats_quantile(all, mirror, 0.1) : 0, irises ? (float)stats_quantile(irises, iris, 0.5) : 0, irises > 0 };
	free(mirror);
	free(iris);
	return v;
}
