/* skull_map: from skin coordinates to the head. Skin slides over the skull: where a vertex stands follows from where it
 * is seen in the modelling camera (skin paper, eqs. 3.15 and 3.16). Position and normal of the skull, with the sockets
 * closed by a smooth surface, as a texture over the camera's image, made by natural-neighbour interpolation of the
 * character's vertices at rest.
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

/* n sites: where they are seen (px), where they are (mm) and their normals. The map covers `box` (x0, y0, x1, y1 px) in
 * texels of `step` px; round it, the sites are continued by the affine map that fits them best, so that an affine chart is
 * reproduced everywhere. False, err set, when the sites span no area. skull_map_free. */
bool skull_map_make(struct skull_map *map, int n, const double (*site)[2], const float (*position)[3], const float (*normal)[3],
                    const double box[4], double step, struct err *err);
void skull_map_free(struct skull_map *map);

/* Position and normal (not normalised) at a point, bilinear, clamped at the border. */
void skull_map_at(float position[3], float normal[3], const struct skull_map *map, const float px[2]);

/* The maps as pictures for other programs: three channels each. image_free. */
struct image skull_map_positions(const struct skull_map *map);
struct image skull_map_normals(const struct skull_map *map);

#endif
