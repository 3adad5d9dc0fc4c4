/* film: light and tear film over a tile of a quick picture: the factors of its maps' colours. */
#ifndef DRAW_EYE_QUICK_FILM_H
#define DRAW_EYE_QUICK_FILM_H
#include "draw/eye/quick/quick.h"

/* The reflection is looked up at every fourth pixel, five by five. */
enum { FILM_STEP = 4, FILM_SIDE = 5, FILM_LANES = 32 };

/* At the nodes: factors of the iris' and of the sclera's colour; what is mirrored, with the cover. */
struct quick_film {
	quick_four iris[NODE_LANES], white[NODE_LANES], mirror[FILM_SIDE * FILM_SIDE];
	int step;  // pixels between lookups of the reflection; 1: it has an edge, and is looked up in every pixel instead
};

void quick_film_make(struct quick_film *film, struct quick_found *found, const struct quick_look *look);

#endif
