/* wrinkle_map: the bump maps of expressions that `track` writes. Their chart: px of the modelling camera's picture of the skin at
 * rest (rig.home of a character).
 */
#ifndef DRAW_FACE_WRINKLE_MAP_H
#define DRAW_FACE_WRINKLE_MAP_H
#include "image/image.h"

struct wrinkle_maps {
	int n;                     // expressions
	char **name;               // [n]
	bool *folds;               // [n] has any line
	int x0, y0;                // of the chart, px
	double px_per_mm;          // of the subject
	struct image map;          // channels 2 i: height of expression i (mm), 2 i + 1: share of an even sky that is seen
};

/* Reads wrinkles.json and wrinkles.exr of a folder. A folder without them: n = 0, and true. False, err set: damaged files.
 * wrinkle_maps_free in any case. */
bool wrinkle_maps_load(struct wrinkle_maps *maps, const char *dir, struct err *err);
void wrinkle_maps_free(struct wrinkle_maps *maps);

/* Maps blended by strength [n] at a px of the chart: slope of the height (mm a px) and visible share of the sky. False: flat there. */
bool wrinkle_maps_at(float slope[2], float *open, const struct wrinkle_maps *maps, const float *strength, const float px[2]);

#endif
