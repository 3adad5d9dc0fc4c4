/* mesh_check: what a mesh file claims, before a library takes it at its word. data has a zero byte behind it. */
#ifndef MESH_MESH_CHECK_H
#define MESH_MESH_CHECK_H
#include <stddef.h>

#include "base/err.h"

enum mesh_kind { MESH_NONE, MESH_PLY, MESH_OBJ };

/* Kind by content. False, err set, when it is neither. */
bool mesh_kind_of(enum mesh_kind *kind, const char *data, size_t size, struct err *err);

/* False, err set, when it has more than `limit` vertices or faces, claims more than its bytes can hold, has elements
 * other than vertices and faces, or a face whose corner is no vertex. */
bool mesh_check_ply(const char *data, size_t size, long limit, struct err *err);

/* The same for OBJ. *clean: the vertices and faces alone, in the plainest form there is (corners from 1, no texture, no
 * normals, no materials: these name further files); free(). */
bool mesh_clean_obj(char **clean, size_t *clean_size, const char *data, size_t size, long limit, struct err *err);

#endif
