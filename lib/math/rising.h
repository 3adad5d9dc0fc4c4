/* rising: a smooth step. */
#ifndef MATH_RISING_H
#define MATH_RISING_H
#include <math.h>

/* 0 up to from, 1 beyond to, in between the cubic that is level at both; from above to: falling. */
static inline double rising(double x, double from, double to)
{
	const double t = fmin(fmax((x - from) / (to - from), 0), 1);
	return t * t * (3 - 2 * t);
}

#endif
