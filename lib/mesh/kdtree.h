/* kdtree: nearest neighbours among points of any dimension, exact, through FLANN. */
#ifndef MESH_KDTREE_H
#define MESH_KDTREE_H
#include "base/err.h"

struct kdtree;

/* Copies n >= 1 points of `dims` numbers each. kdtree_free. */
struct kdtree *kdtree_new(int n, int dims, const float *points);
void kdtree_free(struct kdtree *tree);

/* The k (<= n) nearest to each of m queries, nearest first: index[m][k] and squared distance distance2[m][k]. */
void kdtree_find(const struct kdtree *tree, int m, const float *queries, int k, int *index, float *distance2);

#endif
