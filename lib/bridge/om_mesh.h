/* om_mesh: triangle meshes read from and written to files, split into manifolds and decimated by OpenMesh. */
#ifndef BRIDGE_OM_MESH_H
#define BRIDGE_OM_MESH_H
#ifdef __cplusplus
extern "C" {
#endif
#include "mesh/mesh.h"

/* Reads a PLY or OBJ file, by content (mesh_clean.h). Polygons become triangles; where the mesh is not manifold, vertices are
 * doubled; colours become linear. mesh_free. Returns false, err set, for more than `limit` vertices or faces, an index out of
 * range, or a number that is not finite. */
bool om_mesh_load(struct mesh *mesh, const char *path, long limit, struct err *err);

/* Writes a binary little-endian PLY beside `path` and renames it; made_by becomes a comment. Returns false, err set, when that
 * fails. */
bool om_mesh_save(const struct mesh *mesh, const char *path, const char *made_by, struct err *err);

/* Decimates to at most target_faces faces by quadric error (Garland and Heckbert 1997). Returns false, err set, where OpenMesh
 * fails. */
bool om_mesh_decimate(struct mesh *mesh, int target_faces, struct err *err);

/* Splits edges of three faces and fans that share one vertex, which makes new vertices behind the others, and leaves out faces with a
 * corner twice.
 * vertex_from, face_from   out: of each vertex and face of the result the row it had before; free()
 * Returns false, err set, mesh unchanged, when too many faces meet in a vertex. */
bool om_mesh_sound(struct mesh *mesh, int32_t **vertex_from, int32_t **face_from, struct err *err);

#ifdef __cplusplus
}
#endif
#endif
