/* scene_quick_film: what light and film make of a tile's maps; between film.c and tile.c. */
#ifndef DRAW_EYE_QUICK_FILM_H
#define DRAW_EYE_QUICK_FILM_H
#include "draw/eye/quick/quick.h"

/* The mirror image is looked up at every fourth pixel, five by five. */
enum { FILM_STEP = 4, FILM_SIDE = 5, FILM_LANES = 32 };

/* At the nodes: what the iris' colour, and the white's, is multiplied by; and what is mirrored, with the cover. */
struct quick_film {
	quick_four iris[NODE_LANES], white[NODE_LANES], mirror[FILM_SIDE * FILM_SIDE];
	int step;  // pixels between what was looked up of the mirror image; 1: it has an edge, and is not in it
};

void quick_film_make(struct quick_film *film, struct quick_found *found, const struct quick_look *look);

#endif
