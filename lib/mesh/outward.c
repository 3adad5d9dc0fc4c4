#include "mesh/outward.h"

#include <stdlib.h>

#include "base/mem.h"
#include "math/vec.h"
#include "mesh/topology.h"

/* Twice the area times the normal of a face. */
static void normal_of(double n[3], const struct mesh *mesh, const int32_t f[3])
{
	double a[3], b[3];
	for (int k = 0; k < 3; k++) {
		a[k] = (double)mesh->vertices[f[1]][k] - (double)mesh->vertices[f[0]][k];
		b[k] = (double)mesh->vertices[f[2]][k] - (double)mesh->vertices[f[0]][k];
	}
	vec_cross(n, a, b);
}

static void middle_of(double m[3], const struct mesh *mesh, const int32_t f[3])
{
	for (int k = 0; k < 3; k++)
		m[k] = ((double)mesh->vertices[f[0]][k] + (double)mesh->vertices[f[1]][k] + (double)mesh->vertices[f[2]][k]) / 3;
}

/* The component with most vertices, by its lowest vertex. */
static int largest(const int *piece, int n)
{
	int *count = mem_new((size_t)n + 1, sizeof *count), best = 0;
	for (int i = 0; i < n; i++)
		count[piece[i]]++;
	for (int i = 0; i < n; i++)
		best = count[i] > count[best] ? i : best;
	free(count);
	return best;
}

double mesh_outward(const struct mesh *mesh)
{
	int *piece = mesh_pieces(mesh->n_vertices, mesh->n_faces, (const int32_t(*)[3])mesh->faces), one = largest(piece, mesh->n_vertices);
	double center[3] = { 0 }, area = 0, flux = 0, most = 0, n[3], m[3];
	for (int pass = 0; pass < 2; pass++)
		for (int f = 0; f < mesh->n_faces; f++) {
			const int32_t *v = mesh->faces[f];
			if (piece[v[0]] != one)
				continue;
			normal_of(n, mesh, v);
			middle_of(m, mesh, v);
			double a = vec_norm(n);
			if (pass) {
				vec_add(m, m, -1 / area, center);
				flux += vec_dot(n, m);
				most += a * vec_norm(m);
			} else {
				vec_add(center, center, a, m);
				area += a;
			}
		}
	free(piece);
	return most > 0 ? flux / most : 0;
}

bool mesh_turn_outward(struct mesh *mesh)
{
	static const double least = 0.1;  // what is nearly flat has no outside
	if (mesh_outward(mesh) > -least)
		return false;
	for (int f = 0; f < mesh->n_faces; f++) {
		int32_t t = mesh->faces[f][1];
		mesh->faces[f][1] = mesh->faces[f][2];
		mesh->faces[f][2] = t;
	}
	return true;
}
