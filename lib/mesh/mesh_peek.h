/* mesh_peek: number of vertices and connectivity of a mesh file, for comparing two files with little memory. */
#ifndef MESH_MESH_PEEK_H
#define MESH_MESH_PEEK_H
#include <stddef.h>

#include "mesh/mesh.h"

/* Number of vertices of a file: by the header of a PLY, the lines of an OBJ. Returns -1 when it cannot be read or is longer than
 * `most` bytes. */
long mesh_peek_vertices(const char *path, size_t most);

/* Reads the mesh of a file as mesh_clean() does. Returns false, mesh empty, when it cannot be read or is longer than `most` bytes.
 * mesh_free. */
bool mesh_peek_faces(struct mesh *mesh, const char *path, size_t most);

#endif
