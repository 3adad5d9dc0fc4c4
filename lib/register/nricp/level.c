#include "register/nricp/level.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "math/vec.h"

static void level_room(struct nricp_level *l)
{
	size_t n = (size_t)l->graph.n + 1;
	l->t = mem_new(n, sizeof *l->t);
	l->turn = mem_new(n, sizeof *l->turn);
	l->pull = mem_array(n, sizeof *l->pull);
	l->affine = mem_array(n, sizeof *l->affine);
	l->normal = mem_array(n, sizeof *l->normal);
	l->out = mem_array(n, sizeof *l->out);
	l->boundary = mem_array(n, 1);
	l->points = mem_new(n, sizeof *l->points);
	l->match = mem_new(n, sizeof *l->match);
	l->data.k = mem_new(n, sizeof *l->data.k);
	l->data.goal = mem_new(n, sizeof *l->data.goal);
	for (int i = 0; i < l->graph.n; i++)
		l->match[i].face = -1;
}

void nricp_level_free(struct nricp_level *l)
{
	void *const all[] = { l->t,   l->turn,     l->pull,   l->affine, l->normal,
		                  l->out, l->boundary, l->points, l->match,  l->data.k, l->data.goal };
	for (int i = 0; i < COUNT(all); i++)
		free(all[i]);
	nricp_twins_free(&l->twins);
	nricp_graph_free(&l->graph);
}

void nricp_level_finest(struct nricp_level *l, const struct mesh *moving, double rigid)
{
	struct topology t;
	topology_make(&t, moving);
	double (*place)[4] = mem_new((size_t)t.n + 1, sizeof *place), *area = mesh_vertex_areas(moving);
	for (int i = 0; i < t.n; i++)
		for (int k = 0; k < 3; k++)
			place[i][k] = moving->vertices[i][k];
	nricp_graph_make(&l->graph, t.n, (const double(*)[4])place, area, t.start, t.neighbour, rigid);
	level_room(l);
	float (*normal)[3] = mesh_normals(moving);
	memcpy(l->normal, normal, (size_t)t.n * sizeof *normal);
	memcpy(l->boundary, t.boundary, (size_t)t.n);
	nricp_outward(l->out, moving, &t, (const float(*)[3])normal);
	free(normal);
	free(place);
	free(area);
	topology_free(&t);
}

void nricp_level_coarser(struct nricp_level *l, const struct nricp_level *fine, int nodes, double rigid)
{
	nricp_graph_coarser(&l->graph, &fine->graph, nodes, rigid);
	level_room(l);
	for (int i = 0; i < l->graph.n; i++) {
		int32_t row = l->graph.row[i];
		memcpy(l->normal[i], fine->normal[row], sizeof *l->normal);
		memcpy(l->out[i], fine->out[row], sizeof *l->out);
		l->boundary[i] = fine->boundary[row];
	}
}

static void turned(float out[3], const double a[3][3], const float v[3])
{
	for (int r = 0; r < 3; r++)
		out[r] = (float)(a[r][0] * (double)v[0] + a[r][1] * (double)v[1] + a[r][2] * (double)v[2]);
}

/* Normals are the cross products of two tangents carried by the affine map. */
void nricp_level_stand(struct nricp_level *l)
{
	for (int i = 0; i < l->graph.n; i++) {
		struct nricp_point *p = &l->points[i];
		const float *n = l->normal[i];
		double (*a)[3] = l->affine[i];
		nricp_graph_affine(a, &l->graph, i, (const double(*)[4])l->t, l->turn[i]);
		for (int k = 0; k < 3; k++) {
			a[k][k] += 1;
			p->at[k] = (float)(l->graph.place[i][k] + l->t[i][k]);
		}
		int least = fabsf(n[0]) < fabsf(n[1]) ? (fabsf(n[0]) < fabsf(n[2]) ? 0 : 2) : fabsf(n[1]) < fabsf(n[2]) ? 1 : 2;
		float u[3], v[3], au[3], av[3];
		for (int k = 0; k < 3; k++)
			u[k] = (k == least) - n[least] * n[k];
		for (int k = 0; k < 3; k++)
			v[k] = n[(k + 1) % 3] * u[(k + 2) % 3] - n[(k + 2) % 3] * u[(k + 1) % 3];
		turned(au, (const double(*)[3])a, u);
		turned(av, (const double(*)[3])a, v);
		for (int k = 0; k < 3; k++)
			p->normal[k] = au[(k + 1) % 3] * av[(k + 2) % 3] - au[(k + 2) % 3] * av[(k + 1) % 3];
		turned(p->out, (const double(*)[3])a, l->out[i]);
		vecf_unit(p->normal);
		vecf_unit(p->out);
		p->boundary = l->boundary[i];
	}
}

/* K = area weight (n n' + slide I): point to plane, and a little point to point. */
void nricp_level_ask(struct nricp_level *l, const struct nricp_conf *conf)
{
	for (int i = 0; i < l->graph.n; i++) {
		const struct nricp_match *m = &l->match[i];
		double w = l->graph.area[i] * (double)m->weight, *k = l->data.k[i];
		double across = m->on_rim ? conf->rim_slide - 1 : 1, all = m->on_rim ? 1 : conf->slide;
		int at = 0;
		for (int r = 0; r < 3; r++) {
			for (int c = r; c < 3; c++)
				k[at++] = w * (across * (double)m->normal[r] * (double)m->normal[c] + (r == c) * all);
			l->data.goal[i][r] = m->goal[r];
		}
	}
}
