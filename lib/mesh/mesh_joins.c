#include "mesh/mesh_joins.h"

#include <stdlib.h>

#include "base/mem.h"

/* About 8 ns each, 4 s in all: 22 000 triangles round one vertex, or 14 million sound vertices of six. */
enum { STEPS_MAX = 500000000 };

bool mesh_joins_check(const struct mesh *mesh, struct err *err)
{
	int32_t *faces = mem_new((size_t)mesh->n_vertices + 1, sizeof *faces), busiest = 0;
	int64_t steps = 0;
	for (int f = 0; f < mesh->n_faces; f++)
		for (int k = 0; k < 3; k++) {
			int32_t v = mesh->faces[f][k], n = ++faces[v];
			steps += 2 * (int64_t)n - 1;
			busiest = n > faces[busiest] ? v : busiest;
		}
	int32_t most = faces[busiest];
	free(faces);
	return steps <= STEPS_MAX || err_set(err, "%d faces meet in vertex %d: too many to be joined", most, busiest);
}

/* The two edges of a face at a vertex: the one that leaves it, and the one that returns to it. */
struct corner {
	int32_t to, from;
};

/* Whether the corners of one vertex form one fan or ring: each edge occurs once in either direction, and one walk visits all. */
static bool is_one_fan(const struct corner *c, int n)
{
	int before = 0;  // the first corner of the fan, or any corner of a ring
	for (int i = 0; i < n; i++) {
		bool follows = false;
		for (int j = 0; j < n; j++) {
			if (j != i && (c[j].to == c[i].to || c[j].from == c[i].from))
				return false;
			follows |= c[j].from == c[i].to;
		}
		before = follows ? before : i;
	}
	int seen = 1;
	for (int at = before, next = -1; seen <= n; at = next, next = -1, seen++) {
		for (int j = 0; j < n; j++)
			next = c[j].to == c[at].from ? j : next;
		if (next < 0 || next == before)
			break;
	}
	return seen == n;
}

bool mesh_joins_sound(const struct mesh *mesh)
{
	enum { MOST = 100 };
	size_t n = (size_t)mesh->n_vertices;
	int32_t *start = mem_new(n + 2, sizeof *start);
	struct corner *corner = mem_array(3 * (size_t)mesh->n_faces + 1, sizeof *corner);
	for (int f = 0; f < mesh->n_faces; f++)
		for (int k = 0; k < 3; k++)
			start[mesh->faces[f][k] + 2]++;
	for (size_t i = 2; i < n + 2; i++)
		start[i] += start[i - 1];
	for (int f = 0; f < mesh->n_faces; f++)
		for (int k = 0; k < 3; k++) {
			const int32_t *v = mesh->faces[f];
			corner[start[v[k] + 1]++] = (struct corner){ v[(k + 1) % 3], v[(k + 2) % 3] };
		}
	bool sound = true;
	for (size_t i = 0; i < n && sound; i++) {
		int count = start[i + 1] - start[i];
		sound = count <= MOST && (!count || is_one_fan(corner + start[i], count));
	}
	free(start);
	free(corner);
	return sound;
}
