#include "mesh/mesh.h"

#include <math.h>
#include <stdlib.h>

#include "base/mem.h"

void mesh_free(struct mesh *mesh)
{
	free(mesh->vertices);
	free(mesh->faces);
	free(mesh->colours);
	*mesh = (struct mesh){ 0 };
}

float (*mesh_normals(const struct mesh *mesh))[3]
{
	float (*normals)[3] = mem_new((size_t)mesh->n_vertices, sizeof *normals);
	for (int f = 0; f < mesh->n_faces; f++) {
		const int32_t *v = mesh->faces[f];
		const float *a = mesh->vertices[v[0]], *b = mesh->vertices[v[1]], *c = mesh->vertices[v[2]];
		float e[3], g[3];
		for (int k = 0; k < 3; k++) {
			e[k] = b[k] - a[k];
			g[k] = c[k] - a[k];
		}
		// The cross product's length is twice the area: summing it weights by area.
		float n[3] = { e[1] * g[2] - e[2] * g[1], e[2] * g[0] - e[0] * g[2], e[0] * g[1] - e[1] * g[0] };
		for (int i = 0; i < 3; i++)
			for (int k = 0; k < 3; k++)
				normals[v[i]][k] += n[k];
	}
	for (int i = 0; i < mesh->n_vertices; i++) {
		float *n = normals[i], len = sqrtf(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
		if (len > 0)
			for (int k = 0; k < 3; k++)
				n[k] /= len;
		else
			n[2] = 1;
	}
	return normals;
}

bool mesh_check(const struct mesh *mesh, struct err *err)
{
	// In any unit, a face is smaller: squares and cubes of lengths stay numbers in float.
	static const float farthest = 1e9f;
	for (int i = 0; i < mesh->n_vertices; i++)
		for (int k = 0; k < 3; k++) {
			float x = mesh->vertices[i][k];
			if (!isfinite(x))
				return err_set(err, "vertex %d: a coordinate that is no number", i);
			if (fabsf(x) > farthest)
				return err_set(err, "vertex %d: coordinate = %g, must be within %g of 0", i, (double)x, (double)farthest);
		}
	return true;
}
