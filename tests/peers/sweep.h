/* sweep: a surface from photographs with known cameras by sweeping planes (Collins 1996): normalised cross-correlation with
 * four neighbours, kept where other pictures' depths agree. Shares nothing with the product's matching, and is the truth
 * its meshes are held against. */
#ifndef TESTS_SWEEP_H
#define TESTS_SWEEP_H
#include "tests/lib/truth/views_truth.h"

struct sweep_points {
	long n;
	float (*xyz)[3], (*normal)[3];  // truth's world; owned
	double center[3], radius;       // the ball that was swept
};

/* images: folder of NAME.jpg. shrink: photographs are reduced by so much. planes: depths tried. */
bool sweep(struct sweep_points *out, const struct views_truth *truth, const char *images, int shrink, int planes,
           struct err *err);
void sweep_free(struct sweep_points *points);

/* Distance of a point from the surface: along the normal of the nearest point of it; INFINITY when none is within reach. */
struct sweep_index;
struct sweep_index *sweep_index_new(const struct sweep_points *points, double reach);
double sweep_distance(const struct sweep_index *index, const double xyz[3]);
void sweep_index_free(struct sweep_index *index);

#endif
