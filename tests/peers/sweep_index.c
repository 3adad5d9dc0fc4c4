#include <math.h>
#include <stdlib.h>

#include "base/mem.h"
#include "math/vec.h"
#include "tests/peers/sweep.h"

/* Points sorted into cells of the reach: 27 of them hold all that is near. */
struct sweep_index {
	const struct sweep_points *points;
	double edge, low[3];
	int size[3];
	long *start, *order;
};

static long cell_of(const struct sweep_index *x, const double p[3], int at[3])
{
	for (int k = 0; k < 3; k++) {
		at[k] = (int)floor((p[k] - x->low[k]) / x->edge);
		if (at[k] < 0 || at[k] >= x->size[k])
			return -1;
	}
	return ((long)at[2] * x->size[1] + at[1]) * x->size[0] + at[0];
}

struct sweep_index *sweep_index_new(const struct sweep_points *points, double reach)
{
	struct sweep_index *x = mem_new(1, sizeof *x);
	x->points = points;
	x->edge = reach;
	for (int k = 0; k < 3; k++) {
		x->low[k] = points->center[k] - points->radius - reach;
		x->size[k] = (int)ceil((2 * points->radius + 2 * reach) / reach) + 1;
	}
	long cells = (long)x->size[0] * x->size[1] * x->size[2];
	x->start = mem_new((size_t)cells + 2, sizeof *x->start);
	x->order = mem_array((size_t)points->n, sizeof *x->order);
	for (int pass = 0; pass < 2; pass++) {
		for (long i = 0; i < points->n; i++) {
			double p[3] = { (double)points->xyz[i][0], (double)points->xyz[i][1], (double)points->xyz[i][2] };
			int at[3];
			long c = cell_of(x, p, at);
			if (pass)
				x->order[x->start[c + 1]++] = i;
			else
				x->start[c + 2]++;
		}
		for (long c = 2; c < cells + 2 && !pass; c++)
			x->start[c] += x->start[c - 1];
	}
	return x;
}

double sweep_distance(const struct sweep_index *x, const double xyz[3])
{
	int at[3];
	double best = x->edge * x->edge, along = INFINITY;
	cell_of(x, xyz, at);
	for (int k = 0; k < 27; k++) {
		double near[3];
		int cell[3];
		for (int a = 0; a < 3; a++)
			near[a] = x->low[a] + (at[a] + 0.5 + (a == 0 ? k % 3 : a == 1 ? k / 3 % 3 : k / 9) - 1) * x->edge;
		long c = cell_of(x, near, cell);
		for (long i = c < 0 ? 0 : x->start[c]; c >= 0 && i < x->start[c + 1]; i++) {
			const float *p = x->points->xyz[x->order[i]], *n = x->points->normal[x->order[i]];
			double d[3] = { xyz[0] - (double)p[0], xyz[1] - (double)p[1], xyz[2] - (double)p[2] }, r = vec_dot(d, d);
			if (r < best) {
				best = r;
				along = fabs(d[0] * (double)n[0] + d[1] * (double)n[1] + d[2] * (double)n[2]);
			}
		}
	}
	return along;
}

void sweep_index_free(struct sweep_index *x)
{
	if (x) {
		free(x->start);
		free(x->order);
	}
	free(x);
}
