#include "sfm/cloud/surface.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "mesh/topology.h"

static double area_of(const struct mesh *m, const int32_t f[3])
{
	double u[3], v[3];
	for (int k = 0; k < 3; k++) {
		u[k] = (double)m->vertices[f[1]][k] - (double)m->vertices[f[0]][k];
		v[k] = (double)m->vertices[f[2]][k] - (double)m->vertices[f[0]][k];
	}
	double a = u[1] * v[2] - u[2] * v[1], b = u[2] * v[0] - u[0] * v[2], c = u[0] * v[1] - u[1] * v[0];
	return 0.5 * sqrt(a * a + b * b + c * c);
}

/* Removes the vertices that no face uses; renumbers the faces. */
static void compact(struct mesh *m)
{
	int *to = mem_array((size_t)m->n_vertices, sizeof *to), n = 0;
	for (int i = 0; i < m->n_vertices; i++)
		to[i] = -1;
	for (int f = 0; f < m->n_faces; f++)
		for (int k = 0; k < 3; k++)
			to[m->faces[f][k]] = 0;
	for (int i = 0; i < m->n_vertices; i++) {
		if (to[i] < 0)
			continue;
		memmove(m->vertices[n], m->vertices[i], sizeof *m->vertices);
		if (m->colours)
			memmove(m->colours[n], m->colours[i], sizeof *m->colours);
		to[i] = n++;
	}
	for (int f = 0; f < m->n_faces; f++)
		for (int k = 0; k < 3; k++)
			m->faces[f][k] = to[m->faces[f][k]];
	m->n_vertices = n;
	free(to);
}

void surface_largest(struct mesh *m, const bool *keep)
{
	double *area = mem_new((size_t)m->n_vertices, sizeof *area);
	int best = -1, n = 0;
	for (int f = 0; f < m->n_faces; f++) {
		const int32_t *c = m->faces[f];
		if (!keep || (keep[c[0]] && keep[c[1]] && keep[c[2]]))
			memmove(m->faces[n++], c, sizeof *m->faces);
	}
	m->n_faces = n;
	int *piece = mesh_pieces(m->n_vertices, n, (const int32_t(*)[3])m->faces);
	for (int f = 0; f < n; f++)
		area[piece[m->faces[f][0]]] += area_of(m, m->faces[f]);
	for (int i = 0; i < m->n_vertices; i++)
		if (area[i] > 0 && (best < 0 || area[i] > area[best]))
			best = i;
	n = 0;
	for (int f = 0; f < m->n_faces; f++)
		if (piece[m->faces[f][0]] == best)
			memmove(m->faces[n++], m->faces[f], sizeof *m->faces);
	m->n_faces = n;
	free(piece);
	free(area);
	compact(m);
}
