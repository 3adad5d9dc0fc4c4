/* What the parts of sweep share. */
#ifndef TESTS_SWEEP_IMPL_H
#define TESTS_SWEEP_IMPL_H
#include "tests/peers/sweep.h"

struct shot {
	float *px;          // grey; owned
	int w, h;
	double K[3][3];     // of the reduced picture, px: first pixel's centre at 0
	const struct views_camera *c;
	float *depth;       // z, 0: none; owned
};

/* World point of pixel (x, y) at depth z. */
void shot_lift(double out[3], const struct shot *s, double x, double y, double z);

/* x, y, z of a world point in the picture; false: outside. */
bool shot_drop(double px[3], const struct shot *s, const double world[3]);

/* Fills the depth of shot i of n by sweeping planes at `planes` depths between low and high. */
void shot_sweep(struct shot *shots, int n, int i, const double middle[3], double low, double high, int planes);

#endif
