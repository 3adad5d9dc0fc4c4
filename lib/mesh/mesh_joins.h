/* mesh_joins: how the triangles of a mesh meet, and what it costs to join them. OpenMesh walks round a vertex for each of its
 * faces: a million that share one would take hours. */
#ifndef MESH_MESH_JOINS_H
#define MESH_MESH_JOINS_H
#include "mesh/mesh.h"

/* False, err set, when joining them would take more than seconds. */
bool mesh_joins_check(const struct mesh *mesh, struct err *err);

/* Whether the mesh is a surface wherever it has faces: an edge has one face on either side at most, and the faces round a
 * vertex are one fan or one ring. False too for vertices of more than a hundred faces, which are not looked at. */
bool mesh_joins_sound(const struct mesh *mesh);

#endif
