/* canvas: a picture while its rays are traced; shared by first.c and render.c. */
#ifndef DRAW_EYE_EXACT_CANVAS_H
#define DRAW_EYE_EXACT_CANVAS_H
#include "draw/eye/exact/sight.h"
#include "draw/eye/render.h"

enum { TILE = QUICK_TILE };
_Static_assert(TILE * TILE == BATCH, "a tile's first rays are one batch");

struct canvas {
	const struct scene *scene;
	const struct scene_view *view;
	const struct scene_look *look;
	struct image *image;
	bool bent;  // the lens distorts: rays are not linear in the pixel
	struct sight_plane plane;
};

/* Colours of n <= BATCH rays through points of the picture (px), premultiplied RGBA. Adds to *iris the number that reached the iris. */
void canvas_trace(float rgba[][4], int n, const float *x, const float *y, const struct canvas *canvas, long *iris);

/* Draws the tiles from..to - 1 by a ray through the middle of every pixel. across: tiles in a row of the picture. */
void canvas_first(const struct canvas *canvas, int from, int to, int across, struct scene_count *count);

#endif
