/* storage: error against the bytes stored, the time of one evaluation as the size of the mark: a picture of three things at
 * once, for functions that may be tabulated. */
#ifndef TESTS_STORAGE_H
#define TESTS_STORAGE_H
#include <stdbool.h>

struct storage_point {
	const char *method;  // marks of one method share a colour; equal pointers
	double bytes, seconds, error;
};

/* OUT/NAME.svg through gnuplot; error and its unit as the axis says it. Points that no other beats in storage, time and error
 * together stand in a ring. False when gnuplot fails. */
bool storage_plot(const char *out, const char *name, const char *title, const char *error_axis, int n,
                  const struct storage_point points[]);

#endif
