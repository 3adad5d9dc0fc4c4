/* distance: a screen-space distance field: how far each visible point of the globe is from the nearest visible skin, computed
 * from the drawn picture alone (skin paper, chapter 4). The renderer draws tear film and lid shadow from it.
 *
 * Screen  px, x right, y down, the first pixel's centre at (0.5, 0.5); arrays are [height][width].
 * World   the camera's frame, in the unit of depth (mm); without depth the scene is flat and the unit is one px.
 */
#ifndef IMAGE_DISTANCE_DISTANCE_H
#define IMAGE_DISTANCE_DISTANCE_H
#include <stdbool.h>
#include <stdint.h>

enum distance_material { DISTANCE_OTHER, DISTANCE_GLOBE, DISTANCE_SKIN };

struct distance_scene {
	int width, height;
	const uint8_t *material;  // of each pixel; the paper's M
	const float *coverage;    // share of each pixel that is skin, 0..1, >= 0.5 where material is skin; null: material alone
	const float *depth;       // z of each pixel's surface, > 0; null: flat
	double focal_px, center_px[2];  // pinhole camera; not read in a flat scene
};

/* The cost of a method, for comparison with others: texels of the globe that were computed, texture reads in all. */
struct distance_cost {
	double texels, reads;
};

/* The exact Euclidean distance transform in a band of `reach` round the skin, as two one-dimensional passes; texels and blocks
 * that are farther from skin cost one comparison. Without coverage it is the exact distance between texel centres; with coverage,
 * edges are placed to a fraction of a pixel where coverage crosses one half between texels, and joined by segments.
 * out      [height][width]; the globe's texels alone are written: distance in world units, INFINITY where no skin lies within reach
 * nearest  null, or [height][width][2], out: the offset in px to the nearest edge of the skin
 * reach    world units, > 0
 * cost     out; may be null
 * The result does not depend on the number of threads. */
void distance_band(float *out, float (*nearest)[2], const struct distance_scene *scene, double reach,
                   struct distance_cost *cost);

#endif
