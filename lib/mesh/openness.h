/* openness: ambient occlusion of a mesh's vertices, as the share that is free: 1 on a ball's outside, 0.7 at the bottom of a
 * right-angled groove, almost 0 inside a mouth or behind a lid. */
#ifndef MESH_OPENNESS_H
#define MESH_OPENNESS_H
#include "mesh/mesh.h"

/* open[mesh->n_vertices]: share of the cosine-weighted hemisphere about the vertex normal that no face occludes, 0..1; standard
 * error at most 1/8 (24 rays). Faces are counter-clockwise seen from outside. */
void mesh_openness(float *open, const struct mesh *mesh);

/* hidden[mesh->n_vertices]: whether the openness is below `least`; faster than mesh_openness. */
void mesh_hidden(bool *hidden, const struct mesh *mesh, double least);

/* Share of about `samples` evenly chosen vertices with an openness below `least`. */
double mesh_hidden_share(const struct mesh *mesh, double least, int samples);

#endif
