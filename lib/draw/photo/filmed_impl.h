/* filmed_impl: what filmed.c and filmed_align.c share. */
#ifndef DRAW_PHOTO_FILMED_IMPL_H
#define DRAW_PHOTO_FILMED_IMPL_H
#include "draw/photo/filmed.h"

enum { SIDE = SEEN_SIDE, TEXELS = SIDE * SIDE };

struct filmed_one {
	uint8_t (*rgb)[4];      // [TEXELS] sRGB, weight
	double white[3];        // of its sclera, linear; 0: not seen
	double a[2][3];         // where it shows a place (x, y) of the first view's map: a (x, y, 1), mm
	double px, px_per_mm;   // across the limbus; of the iris' plane, seen through the cornea
	double axis[3];         // from the eye to the camera, the eye's frame, unit
	bool astray;            // cannot be laid onto the first view
	double near;            // how much it counts beside the first
};

struct filmed {
	struct eye eye;
	double sclera_radius, sclera_rgb[3], extent;
	int n;
	struct filmed_one view[FILMED_VIEWS];
	float linear[256];
};

/* filmed_align.c: finds a of every view but the first, the one that shows most of the iris best, which is moved there. */
void filmed_align(struct filmed *f);

#endif
