/* scene_canvas: a picture while its rays are traced; between first.c and view.c. */
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
	bool bent;  // the lens distorts
	struct sight_plane plane;
};

/* Colours of n <= BATCH rays through points of the picture (px). Adds to *iris those that saw the iris. */
void canvas_trace(float rgba[][4], int n, const float *x, const float *y, const struct canvas *canvas, long *iris);

/* A ray through every pixel's middle of the tiles from..to - 1, `across` of them in a row. */
void canvas_first(const struct canvas *canvas, int from, int to, int across, struct scene_count *count);

#endif
