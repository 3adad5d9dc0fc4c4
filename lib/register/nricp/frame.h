/* nricp_frame: the size of a mesh, and meshes carried into another frame and unit. */
#ifndef REGISTER_NRICP_FRAME_H
#define REGISTER_NRICP_FRAME_H
#include "mesh/mesh.h"

/* The size of a mesh: the root mean square distance of its surface from its centroid, about a fifth of the diagonal's length.
 * center  out: the centroid of the surface
 * Returns 0 for a mesh without area. */
double mesh_size(double center[3], const struct mesh *mesh);

/* A copy with vertices (m x - center) scale, x homogeneous. Owns its vertices alone, free(): its faces are the mesh's own, and it
 * has no colours. */
struct mesh nricp_carried(const struct mesh *mesh, const double m[4][4], const double center[3], double scale);

#endif
