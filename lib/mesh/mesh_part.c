#include "mesh/mesh_part.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "mesh/topology.h"

static uint64_t hash_of(const float p[3])
{
	uint64_t h = 0;
	for (int k = 0; k < 3; k++) {
		float x = p[k] + 0.0f;  // -0 is 0
		uint32_t bits;
		memcpy(&bits, &x, sizeof bits);
		h = (h ^ bits) * 0x9e3779b97f4a7c15;
		h ^= h >> 29;
	}
	return h;
}

static bool is_same(const float a[3], const float b[3])
{
	return a[0] == b[0] && a[1] == b[1] && a[2] == b[2];
}

/* first[i]: the first vertex with exactly the position of i. */
static int32_t *join(int *doubled, const struct mesh *mesh)
{
	size_t room = 64;
	while (room < 2 * (size_t)mesh->n_vertices)
		room *= 2;
	int32_t *table = mem_array(room, sizeof *table), *first = mem_array((size_t)mesh->n_vertices + 1, sizeof *first);
	memset(table, 0xff, room * sizeof *table);
	*doubled = 0;
	for (int32_t i = 0; i < mesh->n_vertices; i++) {
		size_t at = hash_of(mesh->vertices[i]) & (room - 1);
		while (table[at] >= 0 && !is_same(mesh->vertices[table[at]], mesh->vertices[i]))
			at = (at + 1) & (room - 1);
		if (table[at] < 0)
			table[at] = i;
		first[i] = table[at];
		*doubled += first[i] != i;
	}
	free(table);
	return first;
}

static double area_of(const struct mesh *mesh, const int32_t v[3])
{
	double e[3], g[3];
	for (int k = 0; k < 3; k++) {
		e[k] = (double)mesh->vertices[v[1]][k] - (double)mesh->vertices[v[0]][k];
		g[k] = (double)mesh->vertices[v[2]][k] - (double)mesh->vertices[v[0]][k];
	}
	double x = e[1] * g[2] - e[2] * g[1], y = e[2] * g[0] - e[0] * g[2], z = e[0] * g[1] - e[1] * g[0];
	double a = sqrt(x * x + y * y + z * z) / 2, longest = fmax(e[0] * e[0] + e[1] * e[1] + e[2] * e[2],
	                                                            g[0] * g[0] + g[1] * g[1] + g[2] * g[2]);
	return a > 1e-7 * longest ? a : 0;
}

/* Chooses the components that stay. */
static bool *choose(struct mesh_part *out, const struct mesh *joined, const struct topology *t, double least)
{
	double *area = mem_new((size_t)t->n_pieces + 1, sizeof *area), largest = 0;
	bool *open = mem_new((size_t)t->n_pieces + 1, sizeof *open), *keep = mem_new((size_t)t->n_pieces + 1, sizeof *keep);
	for (int f = 0; f < joined->n_faces; f++) {
		double a = area_of(joined, joined->faces[f]);
		area[t->piece[joined->faces[f][0]]] += a;
		out->whole_area += a;
		out->flat += !(a > 0);
	}
	for (int i = 0; i < t->n; i++)
		open[t->piece[i]] |= t->boundary[i];
	for (int p = 0; p < t->n_pieces; p++)
		largest = fmax(largest, area[p]);
	for (int p = 0; p < t->n_pieces; p++) {
		keep[p] = area[p] > 0 && area[p] >= largest * (open[p] ? least : fmax(least, 0.5));
		out->pieces += area[p] > 0;
		out->left_out += area[p] > 0 && !keep[p];
		out->area += keep[p] ? area[p] : 0;
	}
	free(area);
	free(open);
	return keep;
}

static int count_rims(const struct topology *t)
{
	int32_t *next = mem_array((size_t)t->n + 1, sizeof *next), rims = 0;
	memset(next, 0xff, (size_t)t->n * sizeof *next);
	for (int e = 0; e < t->n_rim; e++)
		next[t->rim[e][0]] = t->rim[e][1];
	for (int i = 0; i < t->n; i++)
		if (next[i] >= 0) {
			rims++;
			for (int32_t at = i; at >= 0 && next[at] >= 0;) {
				int32_t to = next[at];
				next[at] = -1;
				at = to;
			}
		}
	free(next);
	return rims;
}

static bool all_marked(const bool *mark, const int32_t v[3])
{
	return mark && mark[v[0]] && mark[v[1]] && mark[v[2]];
}

/* The kept faces and their vertices, in the whole's order. */
static void copy_kept(struct mesh_part *out, const struct mesh *whole, const struct mesh *joined, const int32_t *first,
                      const struct topology *t, const bool *keep, const bool *leave)
{
	size_t n = (size_t)whole->n_vertices, m = (size_t)whole->n_faces;
	struct mesh *mesh = &out->mesh;
	mesh->vertices = mem_array(n + 1, sizeof *mesh->vertices);
	mesh->faces = mem_array(m + 1, sizeof *mesh->faces);
	out->row = mem_array(n + 1, sizeof *out->row);
	out->of = mem_array(n + 1, sizeof *out->of);
	out->face = mem_array(m + 1, sizeof *out->face);
	uint8_t *used = mem_new(n + 1, 1);
	for (int f = 0; f < joined->n_faces; f++)
		if (keep[t->piece[joined->faces[f][0]]] && !all_marked(leave, joined->faces[f]) && area_of(joined, joined->faces[f]) > 0) {
			memcpy(mesh->faces[mesh->n_faces], joined->faces[f], sizeof *mesh->faces);
			out->face[mesh->n_faces++] = f;
			for (int k = 0; k < 3; k++)
				used[joined->faces[f][k]] = 1;
		}
	for (int32_t i = 0; i < whole->n_vertices; i++) {
		out->of[i] = -1;
		if (first[i] != i)
			out->of[i] = out->of[first[i]];
		else if (used[i]) {
			memcpy(mesh->vertices[mesh->n_vertices], whole->vertices[i], sizeof *mesh->vertices);
			out->row[mesh->n_vertices] = i;
			out->of[i] = mesh->n_vertices++;
		}
	}
	for (int f = 0; f < mesh->n_faces; f++)
		for (int k = 0; k < 3; k++)
			mesh->faces[f][k] = out->of[mesh->faces[f][k]];
	free(used);
}

void mesh_part_make(struct mesh_part *out, const struct mesh *whole, double least, const bool *leave)
{
	*out = (struct mesh_part){ 0 };
	int32_t *first = join(&out->doubled, whole);
	struct mesh joined = *whole;
	joined.faces = mem_array((size_t)whole->n_faces + 1, sizeof *joined.faces);
	for (int f = 0; f < whole->n_faces; f++)
		for (int k = 0; k < 3; k++)
			joined.faces[f][k] = first[whole->faces[f][k]];
	struct topology t;
	topology_make(&t, &joined);
	bool *keep = choose(out, &joined, &t, least);
	copy_kept(out, whole, &joined, first, &t, keep, leave);
	if (out->mesh.n_vertices < whole->n_vertices || out->mesh.n_faces < whole->n_faces) {
		topology_free(&t);
		topology_make(&t, &out->mesh);
	}
	out->tangled = t.n_tangled;
	out->rims = count_rims(&t);
	topology_free(&t);
	free(keep);
	free(first);
	free(joined.faces);
}

void mesh_part_free(struct mesh_part *p)
{
	mesh_free(&p->mesh);
	free(p->row);
	free(p->of);
	free(p->face);
	*p = (struct mesh_part){ 0 };
}
