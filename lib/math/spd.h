/* spd: sparse symmetric positive definite systems through CHOLMOD. The fill-reducing order is found once for a pattern and
 * serves every matrix of that pattern. */
#ifndef MATH_SPD_H
#define MATH_SPD_H
#include <stdbool.h>
#include <stdint.h>

struct spd;

/* Pattern of n rows, compressed; of each entry i j only those with j <= i count. Keeps nothing of the caller's. spd_free. */
struct spd *spd_new(int n, const int32_t *start, const int32_t *column);
void spd_free(struct spd *spd);

/* Factors the matrix with these values in the pattern's order. False: not positive definite. */
bool spd_factor(struct spd *spd, const double *value);

/* x[n] gets the solution for b[n]; may be the same. */
void spd_solve(struct spd *spd, double *x, const double *b);

#endif
