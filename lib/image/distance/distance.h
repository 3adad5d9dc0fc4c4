/* distance: how far each visible point of the globe is from the nearest visible skin, from the screen alone (skin
 * paper, chapter 4): what tear film and lid shadow are drawn from.
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
	const float *coverage;    // share of each pixel that is skin, 0..1, a half and more where it is skin; null: mask alone
	const float *depth;       // z of each pixel's surface, > 0; null: flat
	double focal_px, center_px[2];  // pinhole camera; not read in a flat scene
};

/* What a method read, for comparison with others: texels of the globe asked about, texture reads in all. */
struct distance_cost {
	double texels, reads;
};

/* Every method writes the globe's texels of out[height][width], and no others: distance in world units, INFINITY where
 * no skin was found within `reach` (world units, > 0). Results do not depend on the number of threads. cost may be
 * null. */

/* Ours: the exact transform in the band of `reach` round the skin, as two one-dimensional passes; texels and blocks
 * that are farther from skin cost one comparison. On a mask it equals the exact Euclidean distance between texel
 * centres; with coverage, edges are placed to a fraction of a pixel by the crossings of one half between texels, and
 * joined by segments. nearest: null, or [height][width][2], the offset in px to the skin's nearest edge. */
void distance_band(float *out, float (*nearest)[2], const struct distance_scene *scene, double reach,
                   struct distance_cost *cost);

#endif
