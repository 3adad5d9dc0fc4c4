/* globe_map: the eyeball's outside as a distance from its centre in every direction, D(alpha) (skin paper, eq. 3.12).
 * Kept on an octahedron unfolded about -z (the back of the eye): one division and no arc functions a lookup, even
 * sampling, no poles; globe_map_polar gives the paper's own chart.
 * Frame: the globe's at rest, origin in its centre, z out through the pupil, x to the person's left, y up; mm.
 */
#ifndef RIG_GLOBE_MAP_H
#define RIG_GLOBE_MAP_H
#include "image/image.h"
#include "mesh/mesh.h"

struct globe_map {
	int n;          // cells across; the map has (n + 1)^2 nodes, of which the outermost lie on the seam twice
	float *radius;  // [n + 1][n + 1], mm; owned
};

/* From any mesh round the origin: the outermost crossing in each direction. Where it has holes: what its rim gives.
 * False, err set, when less than half of all directions meet it. */
bool globe_map_from_mesh(struct globe_map *map, int n, const struct mesh *mesh, struct err *err);

/* A sphere, and a cornea on it: a spherical cap of that radius whose apex lies `apex` from the centre (0: none). */
struct globe_map globe_map_round(int n, double radius, double cornea_radius, double apex);

void globe_map_free(struct globe_map *map);

/* D in a direction of any length but 0. */
float globe_map_at(const struct globe_map *map, const float dir[3]);

/* The paper's chart: columns atan2(x, z) from -pi to pi, rows acos(y / r) from 0 to pi; one channel. image_free. */
struct image globe_map_polar(const struct globe_map *map, int height);

#endif
