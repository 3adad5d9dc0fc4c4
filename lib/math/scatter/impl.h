/* scatter_impl: what the files of this folder share. */
#ifndef MATH_SCATTER_IMPL_H
#define MATH_SCATTER_IMPL_H
#include "math/scatter/scatter.h"

enum { SCATTER_TILE = 256 };

/* The t-th tile of the lower triangle of a matrix of p columns: first row and column, number of rows and columns. */
struct scatter_tile {
	int i0, j0, ni, nj;
};
struct scatter_tile scatter_tile(int p, int t);
/* Their number. */
int scatter_tiles(int p);

/* Columns from..from+n-1 of the rows kept, centred and scaled by the roots of their weights: [s->n][n]; free(). */
double *scatter_centred(const struct scatter *s, int from, int n);

/* S += Y^T Y, with Y the first `rows` rows of s->work, by the split (scatter_split). */
void scatter_split_add(struct scatter *s, int rows);
void scatter_split_free(struct scatter *s);

#endif
