/* openness: how much of what is before a surface is free: 1 on a ball's outside, 0.7 at the bottom of a right-angled groove, next to
 * nothing inside a mouth or behind a lid. */
#ifndef MESH_OPENNESS_H
#define MESH_OPENNESS_H
#include "mesh/mesh.h"

/* open [mesh->n_vertices]: of the light that a vertex would get from an even sky round it (weights by the cosine with its
 * normal), the share that no face stands before; to an eighth's standard deviation or better. Faces wind counterclockwise
 * seen from outside. */
void mesh_openness(float *open, const struct mesh *mesh);

/* hidden [mesh->n_vertices]: whose openness is below `least`; faster than to measure it. */
void mesh_hidden(bool *hidden, const struct mesh *mesh, double least);

/* Share of about `samples` vertices, evenly taken, with an openness below `least`. */
double mesh_hidden_share(const struct mesh *mesh, double least, int samples);

#endif
