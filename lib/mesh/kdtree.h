/* kdtree: exact nearest neighbours among points of any dimension, by a k-d tree (FLANN). */
#ifndef MESH_KDTREE_H
#define MESH_KDTREE_H
#include "base/err.h"

struct kdtree;

/* Builds a tree of points[n][dims], n >= 1, which are copied. kdtree_free. */
struct kdtree *kdtree_new(int n, int dims, const float *points);
void kdtree_free(struct kdtree *tree);

/* Finds the k (<= n) nearest points to each of queries[m][dims], nearest first: index[m][k] and squared distance distance2[m][k].
 * */
void kdtree_find(const struct kdtree *tree, int m, const float *queries, int k, int *index, float *distance2);

#endif
