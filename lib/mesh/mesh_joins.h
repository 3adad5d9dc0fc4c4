/* mesh_joins: what it costs to join triangles at their vertices. OpenMesh walks round a vertex for each of its faces: a
 * million that share one would take hours. */
#ifndef MESH_MESH_JOINS_H
#define MESH_MESH_JOINS_H
#include <stdint.h>

#include "base/err.h"

struct mesh_joins {
	int32_t *faces;    // [vertex] how many have it as a corner; owned
	int64_t steps;     // sum of their squares
	int32_t busiest;   // the vertex of the most
};

struct mesh_joins mesh_joins_begin(long n_vertices);
void mesh_joins_add(struct mesh_joins *joins, const int32_t corner[3]);

/* Frees. False, err set, when joining them would take more than seconds. */
bool mesh_joins_end(struct mesh_joins *joins, struct err *err);

#endif
