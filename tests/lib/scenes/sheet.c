#include "tests/lib/scenes/sheet.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"

static double bump(double x, double y, double cx, double cy, double wide, double high, double tall)
{
	return tall * exp(-pow((x - cx) / wide, 2) - pow((y - cy) / high, 2));
}

double sheet_height(double x, double y)
{
	return -0.012 * x * x - 0.006 * y * y + bump(x, y, 1, -10, 9, 20, 22) - bump(x, y, -28, 18, 12, 8, 9) - bump(x, y, 27, 19, 13, 8, 8)
	       + bump(x, y, 3, -48, 16, 9, 10) + bump(x, y, -25, 34, 22, 5, 4) + bump(x, y, 24, 36, 20, 5, 5);
}

static bool is_cut(double x, double y)
{
	return pow((x + 28) / 9, 2) + pow((y - 18) / 4, 2) < 1 || pow((x - 27) / 9, 2) + pow((y - 19) / 4, 2) < 1;
}

struct mesh sheet_make(int n, int m, bool slits)
{
	struct mesh mesh = { .n_vertices = n * m };
	mesh.vertices = mem_array((size_t)(n * m), sizeof *mesh.vertices);
	mesh.faces = mem_array(2 * (size_t)(n * m), sizeof *mesh.faces);
	for (int j = 0; j < m; j++)
		for (int i = 0; i < n; i++) {
			double x = -60 + 120.0 * i / (n - 1), y = -60 + 120.0 * j / (m - 1);
			float at[3] = { (float)x, (float)y, (float)sheet_height(x, y) };
			memcpy(mesh.vertices[j * n + i], at, sizeof at);
			int32_t a = j * n + i, f[2][3] = { { a, a + 1, a + n + 1 }, { a, a + n + 1, a + n } };
			if (i == n - 1 || j == m - 1 || (slits && is_cut(x, y)))
				continue;
			memcpy(mesh.faces[mesh.n_faces], f, sizeof f);
			mesh.n_faces += 2;
		}
	return mesh;
}

struct mesh sheet_joined(const struct mesh *a, const struct mesh *b)
{
	struct mesh mesh = { .n_vertices = a->n_vertices + b->n_vertices, .n_faces = a->n_faces + b->n_faces };
	mesh.vertices = mem_array((size_t)mesh.n_vertices + 1, sizeof *mesh.vertices);
	mesh.faces = mem_array((size_t)mesh.n_faces + 1, sizeof *mesh.faces);
	memcpy(mesh.vertices, a->vertices, (size_t)a->n_vertices * sizeof *mesh.vertices);
	memcpy(mesh.vertices + a->n_vertices, b->vertices, (size_t)b->n_vertices * sizeof *mesh.vertices);
	memcpy(mesh.faces, a->faces, (size_t)a->n_faces * sizeof *mesh.faces);
	for (int f = 0; f < b->n_faces; f++)
		for (int k = 0; k < 3; k++)
			mesh.faces[a->n_faces + f][k] = b->faces[f][k] + a->n_vertices;
	return mesh;
}

void sheet_move(struct mesh *mesh, double scale, double angle, const double shift[3])
{
	double c = cos(angle), s = sin(angle) / sqrt(3), o = (1 - c) / 3;
	for (int i = 0; i < mesh->n_vertices; i++) {
		double p[3], sum = 0;
		for (int k = 0; k < 3; k++)
			sum += p[k] = mesh->vertices[i][k];
		for (int k = 0; k < 3; k++)
			mesh->vertices[i][k] = (float)(scale * (c * p[k] + o * sum + s * (p[(k + 2) % 3] - p[(k + 1) % 3])) + shift[k]);
	}
}
