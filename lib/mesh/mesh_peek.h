/* mesh_peek: whether two mesh files hold the same faces of the same vertices, without more of them in memory than that takes. */
#ifndef MESH_MESH_PEEK_H
#define MESH_MESH_PEEK_H
#include <stddef.h>

#include "mesh/mesh.h"

/* Vertices that a file says it has: a PLY's head, lines of an OBJ. -1: it cannot be read, or is longer than `most` bytes. */
long mesh_peek_vertices(const char *path, size_t most);

/* The mesh's faces; its vertices as they stand, no colours. False: it cannot be read, or is longer than `most` bytes.
 * mesh_free. */
bool mesh_peek_faces(struct mesh *mesh, const char *path, size_t most);

#endif
