#include "register/nricp/frame.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "mesh/topology.h"

double mesh_size(double center[3], const struct mesh *mesh)
{
	double *area = mesh_vertex_areas(mesh), sum = 0, size = 0;
	memset(center, 0, 3 * sizeof *center);
	for (int i = 0; i < mesh->n_vertices; i++) {
		sum += area[i];
		for (int k = 0; k < 3; k++)
			center[k] += area[i] * (double)mesh->vertices[i][k];
	}
	for (int k = 0; k < 3 && sum > 0; k++)
		center[k] /= sum;
	for (int i = 0; i < mesh->n_vertices && sum > 0; i++)
		for (int k = 0; k < 3; k++)
			size += area[i] * pow((double)mesh->vertices[i][k] - center[k], 2) / sum;
	free(area);
	return sqrt(size);
}

struct mesh nricp_carried(const struct mesh *mesh, const double m[4][4], const double center[3], double scale)
{
	struct mesh out = *mesh;
	out.colours = 0;
	out.vertices = mem_array((size_t)mesh->n_vertices + 1, sizeof *out.vertices);
	for (int i = 0; i < mesh->n_vertices; i++)
		for (int r = 0; r < 3; r++) {
			double x = m[r][3];
			for (int c = 0; c < 3; c++)
				x += m[r][c] * (double)mesh->vertices[i][c];
			out.vertices[i][r] = (float)((x - center[r]) * scale);
		}
	return out;
}
