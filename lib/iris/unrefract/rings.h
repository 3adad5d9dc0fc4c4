/* rings: the iris between pupil and limbus as a sheet in polar coordinates, and robust statistics of its rings.
 * Internal to lib/iris.
 * Coordinates  t runs from the pupil's margin (0) to the limbus (1); phi is the angle about the pupil's centre, from +x towards
 *              +y. Planes are iris maps [size][size].
 */
#ifndef IRIS_UNREFRACT_RINGS_H
#define IRIS_UNREFRACT_RINGS_H
#include "iris/unrefract/unrefract.h"

enum { SHEET_RINGS = 64, SHEET_ANGLES = 360 };

struct sheet {
	int size;
	double extent;        // half-width of the planes, mm
	struct circle pupil;
	double limbus;        // radius about the axis, mm
	const double *open;   // [SHEET_ANGLES] how sure it is that no lid covers the iris there, 0..1; null: unknown
};

/* t of a point (mm). */
double sheet_t(const struct sheet *sheet, double x, double y);

/* The point (mm) at t and phi. */
void sheet_point(double xy[2], const struct sheet *sheet, double t, double phi);

/* A plane at a point (mm). */
float sheet_sample(const float *plane, const struct sheet *sheet, const double xy[2]);

/* Weighted median and spread (quartile distance over 1.349) of a plane on each ring. */
struct rings {
	float median[SHEET_RINGS], scale[SHEET_RINGS];
};

/* plane, weight  [size][size]
 * favour         angles that no lid covers weigh more: those of sheet->open, without it left and right
 * min_scale      least spread
 * Rings of which too little is seen take the values of their neighbours. */
struct rings rings_of(const float *plane, const float *weight, const struct sheet *sheet, bool favour,
                      float min_scale);

/* Limits each ring's spread to 1.2 times the median spread: the blurred edges of pupil and limbus do not count as spread. */
void rings_even(struct rings *rings);

/* The median at t, interpolated between rings. */
float rings_median(const struct rings *rings, double t);

/* Standard score at t: (value - median) / spread. */
float rings_z(const struct rings *rings, float value, double t);

#endif
