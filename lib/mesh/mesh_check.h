/* mesh_check: what a mesh file claims, before a library takes it at its word. */
#ifndef MESH_MESH_CHECK_H
#define MESH_MESH_CHECK_H
#include <stddef.h>

#include "base/err.h"

enum mesh_kind { MESH_NONE, MESH_PLY, MESH_OBJ };

/* Kind by content. False, err set, when it is neither, has more than `limit` vertices or faces, claims more than its
 * bytes can hold, or has a face whose corner is no vertex. data has a zero byte behind it. */
bool mesh_check(enum mesh_kind *kind, const char *data, size_t size, long limit, struct err *err);

/* The part of it for PLY. */
bool mesh_check_ply(const char *data, size_t size, long limit, struct err *err);

#endif
