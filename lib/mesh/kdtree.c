#include "mesh/kdtree.h"

#include <stdlib.h>
#include <string.h>

// FLANN's C header has a comment within a comment and a macro of C++.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wpedantic"
#include <flann/flann.h>
#pragma GCC diagnostic pop

#include "base/mem.h"

struct kdtree {
	float *points;
	flann_index_t index;
	struct FLANNParameters how;
};

struct kdtree *kdtree_new(int n, int dims, const float *points)
{
	struct kdtree *t = mem_new(1, sizeof *t);
	float speedup;
	t->points = mem_array((size_t)n * (size_t)dims, sizeof *t->points);
	memcpy(t->points, points, (size_t)n * (size_t)dims * sizeof *points);
	t->how = DEFAULT_FLANN_PARAMETERS;
	t->how.algorithm = FLANN_INDEX_KDTREE_SINGLE;
	t->how.checks = FLANN_CHECKS_UNLIMITED;
	t->how.leaf_max_size = 10;
	t->how.sorted = 1;
	t->how.cores = 1;
	t->how.log_level = FLANN_LOG_NONE;
	t->index = flann_build_index_float(t->points, n, dims, &speedup, &t->how);
	return t;
}

void kdtree_free(struct kdtree *t)
{
	if (!t)
		return;
	flann_free_index_float(t->index, &t->how);
	free(t->points);
	free(t);
}

void kdtree_find(const struct kdtree *t, int m, const float *queries, int k, int *index, float *distance2)
{
	struct FLANNParameters how = t->how;
	flann_find_nearest_neighbors_index_float(t->index, (float *)queries, m, index, distance2, k, &how);
}
