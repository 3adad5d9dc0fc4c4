/* nricp_noise: how noisy a mesh is. */
#ifndef REGISTER_NRICP_NOISE_H
#define REGISTER_NRICP_NOISE_H
#include "mesh/mesh.h"
#include "mesh/topology.h"

/* Estimates the noise of a mesh across its surface, robustly, from vertices against the mean of their neighbours; smooths the
 * normals by as much as that noise over the edges' length has turned them.
 * normals   [vertices], unit; replaced by means with their neighbours'
 * topology  of mesh
 * Returns the standard deviation in the mesh's unit; 0 where it has no inner vertices. */
double nricp_noise(float (*normals)[3], const struct mesh *mesh, const struct topology *topology);

#endif
