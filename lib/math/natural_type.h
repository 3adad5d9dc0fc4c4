/* natural_type: the triangulation, between natural.c and natural_delaunay.c. */
#ifndef MATH_NATURAL_TYPE_H
#define MATH_NATURAL_TYPE_H
#include "math/natural.h"

struct natural_triangle {
	int site[3];          // counter-clockwise (x right, y up)
	int beyond[3];        // the triangle across the edge opposite to that site; -1: the hull
	double center[2];     // of the circumcircle
	double radius2;
};

struct natural {
	int n_sites, n;
	double (*site)[2];
	struct natural_triangle *triangle;
};

/* Circumcentre of three points. */
void natural_circumcenter(double out[2], const double a[2], const double b[2], const double c[2]);

#endif
