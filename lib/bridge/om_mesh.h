/* om_mesh: triangle meshes in and out; what is no surface is taken apart, and decimated, by OpenMesh. */
#ifndef BRIDGE_OM_MESH_H
#define BRIDGE_OM_MESH_H
#ifdef __cplusplus
extern "C" {
#endif
#include "mesh/mesh.h"

/* PLY or OBJ by content. Polygons are cut into triangles. More than limit vertices or faces, an index out of range,
 * a number that is not finite: an error. mesh_free. */
bool om_mesh_load(struct mesh *mesh, const char *path, long limit, struct err *err);

/* Binary little-endian PLY; made_by becomes a comment; written beside and renamed. */
bool om_mesh_save(const struct mesh *mesh, const char *path, const char *made_by, struct err *err);

/* Quadric decimation to at most target_faces faces. */
bool om_mesh_decimate(struct mesh *mesh, int target_faces, struct err *err);

#ifdef __cplusplus
}
#endif
#endif
