/* globe_map: the eyeball's surface as the distance from its centre in every direction, D(alpha) (skin paper, eq. 3.12).
 * Stored as an octahedral map, unfolded about -z (the back of the eye): even sampling, no poles, and a lookup of one division and no
 * trigonometric functions; globe_map_polar gives the paper's own chart.
 * Frame: the globe's at rest, origin in its centre, z out through the pupil, x to the person's left, y up; mm.
 */
#ifndef RIG_GLOBE_MAP_H
#define RIG_GLOBE_MAP_H
#include "image/image.h"
#include "mesh/mesh.h"

struct globe_map {
	int n;          // cells across; the map has (n + 1)^2 nodes, the outermost are on the seam and occur twice
	float *radius;  // [n + 1][n + 1], mm; owned
};

/* Makes the map of a mesh around the origin: the outermost intersection in each direction. Holes are filled from their rims.
 * map   overwritten; globe_map_free
 * n     cells across
 * mesh  in the globe's frame, mm
 * Returns false, err set, when less than half of all directions meet the mesh. */
bool globe_map_from_mesh(struct globe_map *map, int n, const struct mesh *mesh, struct err *err);

/* The map of a sphere with a cornea: a spherical cap of cornea_radius whose apex lies `apex` from the centre (0: none). mm.
 * globe_map_free. */
struct globe_map globe_map_round(int n, double radius, double cornea_radius, double apex);

void globe_map_free(struct globe_map *map);

/* D in a direction (of any length but 0), mm, bilinear. */
float globe_map_at(const struct globe_map *map, const float dir[3]);

/* The paper's chart of the map, 2 height x height, one channel, mm: columns atan2(x, z) from -pi to pi, rows acos(y / r) from 0 to pi.
 * image_free. */
struct image globe_map_polar(const struct globe_map *map, int height);

#endif
