/* mesh_clean_ply: mesh_clean() of a file that is a PLY. */
#ifndef MESH_MESH_CLEAN_PLY_H
#define MESH_MESH_CLEAN_PLY_H
#include <stddef.h>

#include "mesh/mesh.h"

/* As mesh_clean() (mesh_clean.h), the kind known. */
bool mesh_clean_ply(struct mesh *mesh, const char *data, size_t size, long limit, struct err *err);

#endif
