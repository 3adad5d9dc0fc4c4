/* glint: reflections of lamps in the cornea. */
#ifndef DRAW_PHOTO_GLINT_H
#define DRAW_PHOTO_GLINT_H
#include "draw/photo/photo.h"

enum { GLINTS_MAX = 6 };

/* Bright pixels that hang together; in px of the shot's view. */
struct glint {
	double sum, x, y;      // light above the iris; its middle
	double rgb[3];         // mean, above the iris
	long n;                // pixels
	double over;           // how many times as light as the upper quarter of what lies round it, mean
	int lo[2], hi[2];      // the box they fill, inclusive
	bool edge;             // reaches the limbus: a lid, more likely than a lamp
};

/* Finds the brightest reflections in a decoded photograph, brightest first; returns how many. */
int glints_find(struct glint glints[GLINTS_MAX], const struct shot *shot);

#endif
