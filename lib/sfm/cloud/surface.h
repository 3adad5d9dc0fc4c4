/* surface: the connected part of a mesh that is kept.
 */
#ifndef SFM_CLOUD_SURFACE_H
#define SFM_CLOUD_SURFACE_H
#include "mesh/mesh.h"

/* Keeps the connected component of the largest area among the faces whose corners are all kept, and the vertices that it uses.
 * keep: [n_vertices]; null: all. Colours go along; vertices keep their order. */
void surface_largest(struct mesh *mesh, const bool *keep);

#endif
