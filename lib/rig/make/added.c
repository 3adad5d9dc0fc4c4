/* Vertices and faces that are added to a rig behind its own. */
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "math/vec.h"
#include "mesh/mesh.h"
#include "rig/make/lining_impl.h"

int32_t lining_vertex(struct lining *m, const double rest[3], double gap)
{
	m->vertex = mem_grow(m->vertex, (size_t)m->n + 1, sizeof *m->vertex);
	m->vertex[m->n] = (struct lining_vertex){ { (float)rest[0], (float)rest[1], (float)rest[2] }, (float)gap, m->side, m->n_of };
	return m->first + m->n++;
}

void lining_follow(struct lining *m, int vertex, double share)
{
	m->of = mem_grow(m->of, (size_t)m->n_of + 1, sizeof *m->of);
	m->share = mem_grow(m->share, (size_t)m->n_of + 1, sizeof *m->share);
	m->of[m->n_of] = vertex;
	m->share[m->n_of++] = (float)share;
}

void lining_face(struct lining *m, int32_t a, int32_t b, int32_t c)
{
	m->faces = mem_grow(m->faces, (size_t)m->n_faces + 1, sizeof *m->faces);
	memcpy(m->faces[m->n_faces++], (int32_t[3]){ a, b, c }, sizeof *m->faces);
}

void lining_over_globe(double out[3], const struct rig *rig, int side, const double head[3], double gap)
{
	const struct rig_globe *g = &rig->globe[side];
	double dir[3], d[3];
	vec_unit(dir, head);
	mat_tvec(d, rig->head_from_target, dir);
	const double far = (double)globe_map_at(&g->map, (float[3]){ (float)dir[0], (float)dir[1], (float)dir[2] }) + gap;
	for (int c = 0; c < 3; c++)
		out[c] = g->center[c] + far * d[c];
}

static void *longer(void *p, int had, int more, size_t size)
{
	char *out = mem_grow(p, (size_t)(had + more) + 1, size);
	memset(out + (size_t)had * size, 0, ((size_t)more + 1) * size);
	return out;
}

static void lengthen(struct rig *rig, const struct lining *m)
{
	const int n = rig->n, k = m->n, entries = rig->bplus.start[n];
	rig->rest = longer(rig->rest, n, k, sizeof *rig->rest);
	rig->normal = longer(rig->normal, n, k, sizeof *rig->normal);
	rig->home = longer(rig->home, n, k, sizeof *rig->home);
	rig->basis = longer(rig->basis, n, k, sizeof *rig->basis);
	rig->fade = longer(rig->fade, n, k, sizeof *rig->fade);
	rig->thickness = longer(rig->thickness, n, k, sizeof *rig->thickness);
	rig->gap = longer(rig->gap, n, k, sizeof *rig->gap);
	rig->glue = longer(rig->glue, n, k, sizeof *rig->glue);
	rig->part = longer(rig->part, n, k, sizeof *rig->part);
	rig->source = longer(rig->source, n, k, sizeof *rig->source);
	rig->side = longer(rig->side, n, k, sizeof *rig->side);
	rig->faces = longer(rig->faces, rig->n_faces, m->n_faces, sizeof *rig->faces);
	rig->bplus.start = longer(rig->bplus.start, n + 1, k, sizeof *rig->bplus.start);
	rig->bplus.column = longer(rig->bplus.column, entries, m->n_of, sizeof *rig->bplus.column);
	rig->bplus.weight = longer(rig->bplus.weight, entries, m->n_of, sizeof *rig->bplus.weight);
}

/* Normals of what was added, and of the edge that it is sewn to. */
static void take_normals(struct rig *rig, const struct lining *m)
{
	const struct mesh mesh = { rig->n, rig->n_faces, rig->rest, rig->faces, 0 };
	float (*normal)[3] = mesh_normals(&mesh);
	for (int i = 0; i < 3 * m->n_faces; i++) {
		const int v = m->faces[i / 3][i % 3];
		memcpy(rig->normal[v], normal[v], sizeof rig->normal[v]);
	}
	free(normal);
}

void lining_append(struct rig *rig, const struct lining *m)
{
	const int n = rig->n, entries = rig->bplus.start[n];
	lengthen(rig, m);
	for (int k = 0; k < m->n; k++) {
		const struct lining_vertex *v = &m->vertex[k];
		const int i = n + k, end = k + 1 < m->n ? m->vertex[k + 1].of : m->n_of;
		memcpy(rig->rest[i], v->rest, sizeof rig->rest[i]);
		rig->gap[i] = rig->thickness[i] = v->gap;
		rig->glue[i] = 1;
		rig->part[i] = RIG_LINING;
		rig->source[i] = RIG_EXTRAPOLATED;
		rig->side[i] = (uint8_t)v->side;
		for (int j = v->of; j < end; j++) {
			const int from = m->of[j];
			rig->bplus.column[entries + j] = from;
			rig->bplus.weight[entries + j] = m->share[j];
			rig->fade[i] += m->share[j] * rig->fade[from];
			for (int c = 0; c < 2; c++)
				rig->home[i][c] += m->share[j] * rig->home[from][c];
			for (int c = 0; c < RIG_BASIS; c++)
				rig->basis[i][c] += m->share[j] * rig->basis[from][c];
		}
		rig->bplus.start[i + 1] = entries + end;
	}
	memcpy(rig->faces + rig->n_faces, m->faces, (size_t)m->n_faces * sizeof *rig->faces);
	rig->n += m->n;
	rig->n_faces += m->n_faces;
	take_normals(rig, m);
}
