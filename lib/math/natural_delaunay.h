/* natural_delaunay: the Delaunay triangulation that natural.c interpolates on. For natural.c alone.
 */
#ifndef MATH_NATURAL_DELAUNAY_H
#define MATH_NATURAL_DELAUNAY_H
#include "math/natural.h"

struct natural_triangle {
	int site[3];          // counter-clockwise (x right, y up)
	int beyond[3];        // the triangle across the edge opposite to that site; -1: none, the edge is of the convex hull
	double center[2];     // of the circumcircle
	double radius2;       // its radius squared
};

struct natural {
	int n_sites, n;                     // sites; triangles
	double (*site)[2];                  // [n_sites], owned
	struct natural_triangle *triangle;  // [n], owned
};

/* Triangulates natural->site by Qhull: allocates and fills natural->triangle and natural->n.
 * False, err set, when the sites span no area. */
bool natural_triangulate(struct natural *natural, struct err *err);

/* Circumcentre of three points. */
void natural_circumcenter(double out[2], const double a[2], const double b[2], const double c[2]);

#endif
