/* mesh_clean: a mesh read from a stranger's PLY or OBJ, every claim of the file checked before memory is taken for it.
 * data   the whole file, with a zero byte behind it
 * Messages have no path: the caller puts it before them (err_wrap).
 */
#ifndef MESH_MESH_CLEAN_H
#define MESH_MESH_CLEAN_H
#include <stddef.h>

#include "mesh/mesh.h"

enum mesh_kind { MESH_NONE, MESH_PLY, MESH_OBJ };

/* PLY by its first line, else OBJ. Returns false, err set, for an empty file and for one with zero bytes that is no PLY. */
bool mesh_kind_of(enum mesh_kind *kind, const char *data, size_t size, struct err *err);

/* Fills mesh with vertices, their colours (sRGB, 0..1) where all vertices have one, and triangles: polygons as fans, without
 * triangles that have a corner twice. Whatever else the file holds is left out. mesh_free, also after false.
 * limit  most vertices, faces and triangles
 * Returns false, err set, when there are more, when the file claims more than its bytes can hold, has elements other than vertices
 * and faces, a coordinate that is no number, a face with a corner that is no vertex, or too many faces round one vertex
 * (mesh_joins.h). */
bool mesh_clean(struct mesh *mesh, const char *data, size_t size, long limit, struct err *err);

#endif
