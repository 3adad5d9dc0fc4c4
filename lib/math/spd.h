/* spd: sparse symmetric positive definite systems through CHOLMOD. The fill-reducing ordering is computed once for a pattern and
 * used for every matrix of that pattern. */
#ifndef MATH_SPD_H
#define MATH_SPD_H
#include <stdbool.h>
#include <stdint.h>

struct spd;

/* Analyses a pattern of n rows in compressed rows: row i has the columns column[start[i]] .. column[start[i + 1] - 1], of which
 * those <= i count (lower triangle). Both arrays are copied. spd_free. */
struct spd *spd_new(int n, const int32_t *start, const int32_t *column);
void spd_free(struct spd *spd);

/* Factors the matrix with these values, in the order of `column`. Returns false when it is not positive definite. */
bool spd_factor(struct spd *spd, const double *value);

/* Solves for x[n] with right-hand side b[n], after spd_factor; x and b may be the same array. */
void spd_solve(struct spd *spd, double *x, const double *b);

#endif
