#include "register/nricp/match.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "math/vec.h"
#include "register/nricp/noise.h"

enum { RIM_PARTS = 4, SMOOTH = 3 };

static float dot(const float a[3], const float b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* The direction off the surface at a boundary edge: perpendicular to the edge, in the tangent plane, as long as the edge. */
static void off_edge(float out[3], const float a[3], const float b[3], const float n[3])
{
	float d[3] = { b[0] - a[0], b[1] - a[1], b[2] - a[2] };
	out[0] = d[1] * n[2] - d[2] * n[1];
	out[1] = d[2] * n[0] - d[0] * n[2];
	out[2] = d[0] * n[1] - d[1] * n[0];
}

void nricp_outward(float (*out)[3], const struct mesh *mesh, const struct topology *t, const float (*normal)[3])
{
	float (*once)[3] = mem_new((size_t)mesh->n_vertices + 1, sizeof *once);
	memset(out, 0, (size_t)mesh->n_vertices * sizeof *out);
	for (int e = 0; e < t->n_rim; e++) {
		const int32_t *v = t->rim[e];
		float o[3];
		off_edge(o, mesh->vertices[v[0]], mesh->vertices[v[1]], normal[v[0]]);
		for (int end = 0; end < 2; end++)
			for (int k = 0; k < 3; k++)
				once[v[end]][k] += o[k];
	}
	for (int pass = 0; pass < SMOOTH; pass++) {
		memcpy(out, once, (size_t)mesh->n_vertices * sizeof *out);
		for (int e = 0; e < t->n_rim; e++)
			for (int k = 0; k < 3; k++) {
				once[t->rim[e][0]][k] += 0.5f*out[t->rim[e][1]][k];
				once[t->rim[e][1]][k] += 0.5f*out[t->rim[e][0]][k];
			}
	}
	for (int i = 0; i < mesh->n_vertices; i++) {
		memcpy(out[i], once[i], sizeof out[i]);
		vecf_unit(out[i]);
	}
	free(once);
}

/* Samples points along the boundary: the ends of its edges, and between them. */
static void take_rim(struct nricp_fixed *f)
{
	const struct topology *t = &f->topology;
	float (*out)[3] = mem_array((size_t)t->n + 1, sizeof *out);
	nricp_outward(out, f->mesh, t, (const float(*)[3])f->normals);
	f->n_rim = RIM_PARTS * t->n_rim;
	f->rim = mem_new((size_t)f->n_rim + 1, sizeof *f->rim);
	f->rim_out = mem_new((size_t)f->n_rim + 1, sizeof *f->rim_out);
	f->rim_along = mem_new((size_t)f->n_rim + 1, sizeof *f->rim_along);
	for (int i = 0; i < f->n_rim; i++) {
		int32_t a = t->rim[i / RIM_PARTS][0], b = t->rim[i / RIM_PARTS][1];
		float w = (float)(i % RIM_PARTS) / RIM_PARTS;
		for (int k = 0; k < 3; k++) {
			f->rim[i][k] = (1 - w) * f->mesh->vertices[a][k] + w * f->mesh->vertices[b][k];
			f->rim_out[i][k] = (1 - w) * out[a][k] + w * out[b][k];
			f->rim_along[i][k] = f->mesh->vertices[b][k] - f->mesh->vertices[a][k];
		}
		vecf_unit(f->rim_out[i]);
		vecf_unit(f->rim_along[i]);
	}
	if (f->n_rim)
		f->rim_tree = kdtree_new(f->n_rim, 3, f->rim[0]);
	free(out);
}

void nricp_fixed_make(struct nricp_fixed *out, const struct mesh *mesh)
{
	*out = (struct nricp_fixed){ .mesh = mesh, .normals = mesh_normals(mesh) };
	topology_make(&out->topology, mesh);
	out->noise = nricp_noise(out->normals, mesh, &out->topology);
	out->scene = closest_new(mesh, (const float(*)[3])out->normals);
	take_rim(out);
}

void nricp_fixed_free(struct nricp_fixed *f)
{
	free(f->normals);
	free(f->rim);
	free(f->rim_out);
	free(f->rim_along);
	topology_free(&f->topology);
	closest_free(f->scene);
	kdtree_free(f->rim_tree);
	*f = (struct nricp_fixed){ 0 };
}

static float welsch(double distance, double scale)
{
	return (float)exp(-(distance * distance) / (scale * scale));
}

/* Whether the closest point lies on the fixed mesh's boundary: the moving surface goes on beyond it and has no counterpart there. */
static bool is_at_end(const struct nricp_fixed *f, const struct closest_point *p)
{
	const int32_t *v = f->mesh->faces[p->face];
	for (int k = 0; k < 3; k++)
		if (p->bary[k] > 1e-4f && !f->topology.boundary[v[k]])
			return false;
	return true;
}

static void match_inside(struct nricp_match *m, const struct nricp_point *p, const struct nricp_fixed *f,
                         const struct nricp_conf *conf, double scale)
{
	struct closest_point c = closest_find(f->scene, p->at, p->normal, (float)conf->turn, INFINITY, m->face);
	m->face = c.face;
	memcpy(m->bary, c.bary, sizeof m->bary);
	m->weight = 0;
	if (c.face < 0 || is_at_end(f, &c))
		return;
	memcpy(m->goal, c.at, sizeof m->goal);
	memcpy(m->normal, c.normal, sizeof m->normal);
	float facing = dot(c.normal, p->normal), across = 0;
	for (int k = 0; k < 3; k++)
		across += (p->at[k] - c.at[k]) * c.normal[k];
	if (facing > conf->facing)
		m->weight = welsch(across, scale);
}

static void match_rim(struct nricp_match *m, const struct nricp_point *p, const struct nricp_fixed *f, const struct nricp_conf *conf)
{
	int at;
	float d2;
	kdtree_find(f->rim_tree, 1, p->at, 1, &at, &d2);
	float out = dot(f->rim_out[at], p->out);
	float w = out > 0 ? out * welsch(sqrt((double)d2), conf->rim_reach) : 0;
	if (!(w > 0.01f))
		return;
	memcpy(m->goal, f->rim[at], sizeof m->goal);
	memcpy(m->normal, f->rim_along[at], sizeof m->normal);
	m->weight = w * (float)conf->rim;
	m->on_rim = true;
}

void nricp_match_all(struct nricp_match *match, int n, const struct nricp_point *points, const struct nricp_fixed *fixed,
                     const struct nricp_conf *conf, double scale)
{
#pragma omp parallel for schedule(dynamic, 256)
	for (int i = 0; i < n; i++) {
		match[i].on_rim = false;
		match_inside(&match[i], &points[i], fixed, conf, scale);
		if (points[i].boundary && conf->rim > 0 && fixed->rim_tree)
			match_rim(&match[i], &points[i], fixed, conf);
	}
}
