/* mesh: a triangle mesh in memory. Lengths in the file's own unit; the caller converts to mm. */
#ifndef MESH_MESH_H
#define MESH_MESH_H
#include <stdint.h>

#include "base/err.h"

struct mesh {
	int n_vertices, n_faces;
	float (*vertices)[3];   // owned
	int32_t (*faces)[3];    // owned; counter-clockwise from outside
	float (*colours)[3];    // linear, 0..1, or null; owned
};

void mesh_free(struct mesh *mesh);

/* Checks the coordinates. Returns false, err set, where one is not finite, or larger than any face's in any unit. */
bool mesh_check(const struct mesh *mesh, struct err *err);

/* Area-weighted unit normals, [n_vertices][3]; (0, 0, 1) where no face gives one. free(). */
float (*mesh_normals(const struct mesh *mesh))[3];

#endif
