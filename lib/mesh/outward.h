/* outward: whether the faces of a mesh are wound counter-clockwise seen from outside. */
#ifndef MESH_OUTWARD_H
#define MESH_OUTWARD_H
#include <stdbool.h>

#include "mesh/mesh.h"

/* Flux of the position from the centroid through the largest connected component, over the integral of its length: 1 for a ball, about
 * 0.6 for a head or a face, 0.2 for a body with its arms stretched out, negative with faces that look inwards, near 0 for what is flat. */
double mesh_outward(const struct mesh *mesh);

/* Winds all faces the other way where mesh_outward says that they look inwards. Returns whether it did. */
bool mesh_turn_outward(struct mesh *mesh);

#endif
