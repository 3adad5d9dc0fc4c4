#include "mesh/topology.h"

#include <math.h>
#include <stdlib.h>

#include "base/mem.h"

static bool is_degenerate(const int32_t f[3])
{
	return f[0] == f[1] || f[1] == f[2] || f[2] == f[0];
}

/* Lists each edge of each face at both its ends: vertex i gets 2 v + 1 for an edge i -> v and 2 v for v -> i, sorted by v. */
static int32_t *half_edges(int32_t *start, const struct mesh *mesh)
{
	int n = mesh->n_vertices;
	for (int f = 0; f < mesh->n_faces; f++)
		for (int k = 0; k < 3 && !is_degenerate(mesh->faces[f]); k++)
			start[mesh->faces[f][k] + 1] += 2;
	for (int i = 0; i < n; i++)
		start[i + 1] += start[i];
	int32_t *out = mem_array((size_t)start[n] + 1, sizeof *out), *fill = mem_array((size_t)n + 1, sizeof *fill);
	for (int i = 0; i < n; i++)
		fill[i] = start[i];
	for (int f = 0; f < mesh->n_faces; f++)
		for (int k = 0; k < 3 && !is_degenerate(mesh->faces[f]); k++) {
			int32_t a = mesh->faces[f][k], b = mesh->faces[f][(k + 1) % 3];
			out[fill[a]++] = 2 * b + 1;
			out[fill[b]++] = 2 * a;
		}
	// Transposing the lists while visiting vertices in rising order sorts them.
	int32_t *rising = mem_array((size_t)start[n] + 1, sizeof *rising);
	for (int i = 0; i < n; i++)
		fill[i] = start[i];
	for (int v = 0; v < n; v++)
		for (int32_t e = start[v]; e < start[v + 1]; e++)
			rising[fill[out[e] / 2]++] = 2 * v + !(out[e] & 1);
	free(fill);
	free(out);
	return rising;
}

/* Numbers the components by falling size; of equal ones that with the lower vertex first. */
static void number_pieces(struct topology *t)
{
	int32_t *stack = mem_array((size_t)t->n + 1, sizeof *stack), *size = mem_new((size_t)t->n + 1, sizeof *size);
	for (int i = 0; i < t->n; i++)
		t->piece[i] = -1;
	for (int i = 0; i < t->n; i++) {
		int top = 0;
		if (t->piece[i] >= 0)
			continue;
		t->piece[stack[top++] = i] = t->n_pieces;
		while (top) {
			int32_t v = stack[--top];
			size[t->n_pieces]++;
			for (int32_t e = t->start[v]; e < t->start[v + 1]; e++)
				if (t->piece[t->neighbour[e]] < 0)
					t->piece[stack[top++] = t->neighbour[e]] = t->n_pieces;
		}
		t->n_pieces++;
	}
	// Counting sort by size, which is stable.
	int32_t *at = mem_new((size_t)t->n + 2, sizeof *at), *rank = mem_array((size_t)t->n_pieces + 1, sizeof *rank);
	for (int p = 0; p < t->n_pieces; p++)
		at[t->n - size[p] + 1]++;
	for (int s = 0; s <= t->n; s++)
		at[s + 1] += at[s];
	for (int p = 0; p < t->n_pieces; p++)
		rank[p] = at[t->n - size[p]]++;
	for (int i = 0; i < t->n; i++)
		t->piece[i] = rank[t->piece[i]];
	free(stack);
	free(size);
	free(at);
	free(rank);
}

void topology_make(struct topology *out, const struct mesh *mesh)
{
	size_t n = (size_t)mesh->n_vertices;
	*out = (struct topology){ .n = mesh->n_vertices };
	out->start = mem_new(n + 1, sizeof *out->start);
	out->boundary = mem_new(n + 1, 1);
	out->piece = mem_array(n + 1, sizeof *out->piece);
	out->neighbour = half_edges(out->start, mesh);
	int32_t written = 0, from = 0, room = 0;
	for (int i = 0; i < mesh->n_vertices; i++) {
		int32_t to = out->start[i + 1];
		out->start[i] = written;
		for (int32_t e = from, count; e < to; e += count) {
			int32_t v = out->neighbour[e] / 2, outwards = 0;
			for (count = 0; e + count < to && out->neighbour[e + count] / 2 == v; count++)
				outwards += out->neighbour[e + count] & 1;
			out->boundary[i] |= count == 1;
			out->n_tangled += count > 2 && v > i;
			if (count == 1 && outwards) {
				if (out->n_rim == room)
					out->rim = mem_grow(out->rim, (size_t)(room = 2 * room + 64), sizeof *out->rim);
				out->rim[out->n_rim][0] = i;
				out->rim[out->n_rim++][1] = v;
			}
			out->neighbour[written++] = v;
		}
		from = to;
	}
	out->start[mesh->n_vertices] = written;
	number_pieces(out);
}

void topology_free(struct topology *t)
{
	free(t->start);
	free(t->neighbour);
	free(t->boundary);
	free(t->rim);
	free(t->piece);
	*t = (struct topology){ 0 };
}

double *mesh_vertex_areas(const struct mesh *mesh)
{
	double *area = mem_new((size_t)mesh->n_vertices + 1, sizeof *area);
	for (int f = 0; f < mesh->n_faces; f++) {
		const int32_t *v = mesh->faces[f];
		double e[3], g[3];
		for (int k = 0; k < 3; k++) {
			e[k] = (double)mesh->vertices[v[1]][k] - (double)mesh->vertices[v[0]][k];
			g[k] = (double)mesh->vertices[v[2]][k] - (double)mesh->vertices[v[0]][k];
		}
		double x = e[1] * g[2] - e[2] * g[1], y = e[2] * g[0] - e[0] * g[2], z = e[0] * g[1] - e[1] * g[0];
		double sixth = sqrt(x * x + y * y + z * z) / 6;
		for (int k = 0; k < 3; k++)
			area[v[k]] += sixth;
	}
	return area;
}

static int root_of(int *parent, int i)
{
	while (parent[i] != i)
		i = parent[i] = parent[parent[i]];
	return i;
}

int *mesh_pieces(int n, int n_faces, const int32_t (*faces)[3])
{
	int *parent = mem_new((size_t)n + 1, sizeof *parent);
	for (int i = 0; i < n; i++)
		parent[i] = i;
	for (int f = 0; f < n_faces; f++)
		for (int k = 1; k < 3; k++) {
			int a = root_of(parent, faces[f][0]), b = root_of(parent, faces[f][k]);
			parent[a > b ? a : b] = a > b ? b : a;
		}
	for (int i = 0; i < n; i++)
		parent[i] = root_of(parent, i);
	return parent;
}
