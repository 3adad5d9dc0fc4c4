/* mesh_joins: connectivity of a mesh: whether it is a manifold surface, and what it costs OpenMesh to build its half-edges:
 * OpenMesh walks round a vertex for each of its faces, so that a million faces at one vertex would take hours. */
#ifndef MESH_MESH_JOINS_H
#define MESH_MESH_JOINS_H
#include "mesh/mesh.h"

/* Returns false, err set, when OpenMesh would take more than seconds for the mesh. */
bool mesh_joins_check(const struct mesh *mesh, struct err *err);

/* Whether the mesh is a manifold (with boundary) wherever it has faces: each edge has at most one face on either side, and the
 * faces round each vertex form one fan or one ring. Returns false for a mesh with a vertex of more than a hundred faces, which is
 * not examined. */
bool mesh_joins_sound(const struct mesh *mesh);

#endif
