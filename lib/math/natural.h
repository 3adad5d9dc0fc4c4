/* natural: natural-neighbour interpolation in the plane (Sibson 1981). Reproduces every affine function exactly inside
 * the sites' convex hull, is smooth away from the sites, and needs no parameter.
 */
#ifndef MATH_NATURAL_H
#define MATH_NATURAL_H
#include "base/err.h"

struct natural;

enum { NATURAL_MAX = 64 };  // neighbours of a point, at most; triangulations of scattered sites have about six

/* Prepares the Delaunay triangulation of sites[n] (Qhull), which are copied. Of coincident sites one is kept. natural_free.
 * Returns null, err set, when there are fewer than three sites or all lie on one line. */
struct natural *natural_new(int n, const double (*sites)[2], struct err *err);
void natural_free(struct natural *natural);

/* Finds the natural neighbours of a point: site[], weight[] (Sibson's coordinates, sum 1).
 * hint  where the search for the triangle begins; kept by the caller from call to call, 0 at first
 * Returns how many; 0 outside the convex hull. May be called by any number of threads, each with a hint of its own. */
int natural_weights(int site[NATURAL_MAX], double weight[NATURAL_MAX], const struct natural *natural, const double at[2],
                    int *hint);

#endif
