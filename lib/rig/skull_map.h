/* skull_map: maps skin coordinates to the head. Skin slides over the skull, so the modelling camera's pixel at which a vertex is seen
 * determines its position (skin paper, eqs. 3.15 and 3.16). A texture over the camera's image holds position and normal of the skull,
 * with the sockets closed by a smooth surface; it is made by natural-neighbour interpolation of the character's vertices at rest.
 */
#ifndef RIG_SKULL_MAP_H
#define RIG_SKULL_MAP_H
#include "image/image.h"

enum { SKULL_CHANNELS = 8 };  // position (mm), normal, two unused: one vector register a texel

struct skull_map {
	double x0, y0, step;  // px of the modelling camera: the first texel's centre, and between texels
	int width, height;
	float *texel;         // [height][width][SKULL_CHANNELS]; owned, 32-byte aligned
};

/* Interpolates n sites. Around them the map is continued by the affine map that fits them best, so that an affine chart is reproduced
 * everywhere.
 * map               overwritten; skull_map_free
 * site              [n] where the sites are seen, px
 * position, normal  [n] mm and unit, in the character's frame
 * box               what the map covers: x0, y0, x1, y1, px; step: px between texels
 * Returns false, err set, when the sites span no area. */
bool skull_map_make(struct skull_map *map, int n, const double (*site)[2], const float (*position)[3], const float (*normal)[3],
                    const double box[4], double step, struct err *err);
/* Takes the mean by a Gaussian of so many px: detail then goes with the skin that it is of, which offsets from the map keep, and not with the place. A map whose texels are
 * further apart than that is left. */
void skull_map_smooth(struct skull_map *map, double px);
void skull_map_free(struct skull_map *map);

/* Position (mm) and normal (not normalised) at a point, px: bilinear, clamped at the border. */
void skull_map_at(float position[3], float normal[3], const struct skull_map *map, const float px[2]);

/* The maps as images of three channels: x y z of the position, mm; of the normal. image_free. */
struct image skull_map_positions(const struct skull_map *map);
struct image skull_map_normals(const struct skull_map *map);

#endif
