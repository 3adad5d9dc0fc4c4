/* region: the ellipse of an iris from the evidence of its pixels alone, to a few hundredths of its radius. */
#ifndef LIMBUS_REGION_H
#define LIMBUS_REGION_H
#include "limbus/evidence.h"
#include "limbus/image.h"
#include "math/ellipse.h"

/* The sum, along each row from its left end, of every pixel's log likelihood ratio "inside of the limbus" against "outside": what the
 * lids hide may be either. */
struct region_map {
	int width, height;
	double x0, y0, scale;
	float *sum;  // [height][width + 1]; owned
};

struct region_map region_map_make(const struct evidence *evidence);
void region_map_free(struct region_map *map);

/* The log likelihood ratio of an ellipse (px of the photograph), as nats in an iris that is REGION_UNIT map px in radius. */
double region_worth(const struct region_map *map, const struct ellipse *e);

/* The chance of sclera, or of what it mirrors, as an absolute tint of a rim. grey_free. */
struct grey region_sclera(const struct evidence *evidence);

/* Mean chance of sclera just outside of the ellipse: how much of it the evidence rests on. */
double region_shown(const struct ellipse *e, const struct evidence *evidence);

/* Climbs to the likeliest ellipse near e. Returns its worth. */
double region_fit(struct ellipse *e, const struct region_map *map);

#endif
