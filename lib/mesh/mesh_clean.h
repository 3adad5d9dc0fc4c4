/* mesh_clean: what a mesh file claims, checked before anybody takes it at its word. data has a zero byte behind it. */
#ifndef MESH_MESH_CLEAN_H
#define MESH_MESH_CLEAN_H
#include <stddef.h>

#include "mesh/mesh.h"

enum mesh_kind { MESH_NONE, MESH_PLY, MESH_OBJ };

/* Kind by content. False, err set, when it is neither. */
bool mesh_kind_of(enum mesh_kind *kind, const char *data, size_t size, struct err *err);

/* Vertices, their colours (sRGB, 0..1) where all have one, and triangles (polygons as fans, without those that have a
 * corner twice); nothing of what else was in the file. mesh_free, also when it is false. False, err set, when it has more
 * than `limit` vertices, faces or triangles, claims more than its bytes hold, has elements other than vertices and faces, a
 * face whose corner is no vertex, or too many round one vertex (mesh_joins.h). */
bool mesh_clean_ply(struct mesh *mesh, const char *data, size_t size, long limit, struct err *err);
bool mesh_clean_obj(struct mesh *mesh, const char *data, size_t size, long limit, struct err *err);

/* Vertices that an OBJ has, by its lines. */
long mesh_clean_obj_vertices(const char *data, size_t size);

#endif
