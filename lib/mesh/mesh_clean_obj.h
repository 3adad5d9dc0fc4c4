/* mesh_clean_obj: mesh_clean() of a file that is an OBJ. */
#ifndef MESH_MESH_CLEAN_OBJ_H
#define MESH_MESH_CLEAN_OBJ_H
#include <stddef.h>

#include "mesh/mesh.h"

/* As mesh_clean() (mesh_clean.h), the kind known. */
bool mesh_clean_obj(struct mesh *mesh, const char *data, size_t size, long limit, struct err *err);

/* Number of vertices that an OBJ has, by its lines. */
long mesh_clean_obj_vertices(const char *data, size_t size);

#endif
