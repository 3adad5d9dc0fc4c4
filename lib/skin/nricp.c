#include "skin/nricp.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "skin/nricp_align.h"
#include "skin/nricp_impl.h"
#include "skin/nricp_match.h"

static const double working_size = 100;  // lengths are brought to a fixed mesh of this size: float has room both ways

struct level {
	struct nricp_graph graph;
	double (*t)[4], (*turn)[9], (*pull)[4], (*affine)[3][3];
	float (*normal)[3], (*out)[3];  // at rest
	uint8_t *boundary;
	struct nricp_point *points;
	struct nricp_match *match;
	struct nricp_pulls data;
};

struct run {
	struct mesh moving, fixed_mesh;  // scaled copies; faces are the caller's
	struct nricp_fixed fixed;
	struct nricp_conf conf;
	struct level level[NRICP_LEVELS + 1];
	int n_levels;                    // level[0] is all vertices, each further one is coarser
	int first;                       // 1: there are too many vertices, level[0] is polished alone
};

static void level_room(struct level *l)
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

static void level_free(struct level *l)
{
	void *const all[] = { l->t,   l->turn,     l->pull,   l->affine, l->normal,
		                  l->out, l->boundary, l->points, l->match,  l->data.k, l->data.goal };
	for (int i = 0; i < COUNT(all); i++)
		free(all[i]);
	nricp_graph_free(&l->graph);
}

static void finest(struct run *run)
{
	struct level *l = &run->level[0];
	struct topology t;
	topology_make(&t, &run->moving);
	double (*place)[4] = mem_new((size_t)t.n + 1, sizeof *place), *area = mesh_vertex_areas(&run->moving);
	for (int i = 0; i < t.n; i++)
		for (int k = 0; k < 3; k++)
			place[i][k] = run->moving.vertices[i][k];
	nricp_graph_make(&l->graph, t.n, (const double(*)[4])place, area, t.start, t.neighbour, run->conf.rigid);
	level_room(l);
	float (*normal)[3] = mesh_normals(&run->moving);
	memcpy(l->normal, normal, (size_t)t.n * sizeof *normal);
	memcpy(l->boundary, t.boundary, (size_t)t.n);
	nricp_outward(l->out, &run->moving, &t, (const float(*)[3])normal);
	free(normal);
	free(place);
	free(area);
	topology_free(&t);
}

static void coarser(struct level *l, const struct level *fine, int nodes, double rigid)
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

static void unit(float v[3])
{
	float len = sqrtf(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
	for (int k = 0; k < 3; k++)
		v[k] = len > 0 ? v[k] / len : 0;
}

/* Where the nodes stand, and which way they face: the plane of two tangents, carried by the affine map. */
static void stand(struct level *l)
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
		unit(p->normal);
		unit(p->out);
		p->boundary = l->boundary[i];
	}
}

/* K = area weight (n n' + slide I): across the surface, and a little along it. */
static void ask(struct level *l, const struct nricp_conf *conf)
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

static void one_level(struct run *run, struct level *l, int rounds, int first, int total, bool direct)
{
	const struct nricp_conf *c = &run->conf;
	double last = c->stiff[1] + c->noise * run->fixed.noise;
	struct nricp_solver *solver = nricp_solver_new(&l->graph, direct, 60, 1e-2);
	for (int i = 0; i < rounds; i++) {
		double at = total > 1 ? (double)(first + i) / (total - 1) : 1;
		double stiff = c->stiff[0] * pow(last / c->stiff[0], at);
		double scale = c->welsch[0] * pow(c->welsch[1] / c->welsch[0], at);
		stand(l);
		nricp_match_all(l->match, l->graph.n, l->points, &run->fixed, c, scale);
		ask(l, c);
		nricp_graph_turns(l->turn, &l->graph, (const double(*)[4])l->t, c->growth);
		nricp_graph_pull(l->pull, &l->graph, (const double(*)[9])l->turn);
		nricp_solver_run(solver, l->t, &l->data, (const double(*)[4])l->pull, pow(stiff, 4));
	}
	nricp_solver_free(solver);
}

static void deform(struct run *run)
{
	int total = 0, done = 0, last = run->n_levels - 1;
	for (int i = last; i >= run->first; i--)
		total += run->conf.rounds[NRICP_LEVELS - 1 - i + run->first];
	for (int i = last; i >= 0; i--) {
		struct level *l = &run->level[i];
		int rounds = i >= run->first ? run->conf.rounds[NRICP_LEVELS - 1 - i + run->first] : 0;
		if (i < last) {
			nricp_graph_spread(l->t, &l->graph, &l[1].graph, (const double(*)[4])l[1].t);
			for (int v = 0; v < l->graph.n; v++)  // where to look first
				l->match[v].face = l[1].match[l[1].graph.parent[v]].face;
		}
		nricp_graph_turns(l->turn, &l->graph, (const double(*)[4])l->t, run->conf.growth);
		one_level(run, l, rounds, done, total, i == last);
		done += rounds;
	}
}

static void finish(struct run *run)
{
	struct level *l = &run->level[0];
	const struct nricp_conf *c = &run->conf;
	nricp_polish(l->points, l->match, &l->graph, &run->fixed, c, c->polish + c->polish_noise * run->fixed.noise);
	nricp_unfold(l->points, &run->moving, &l->graph);
	nricp_match_all(l->match, l->graph.n, l->points, &run->fixed, c, c->welsch[1]);
}

static void build_levels(struct run *run)
{
	const struct nricp_conf *c = &run->conf;
	finest(run);
	run->n_levels = 1;
	run->first = run->level[0].graph.n > 1.3 * c->nodes[NRICP_LEVELS - 1];
	for (int i = NRICP_LEVELS - (run->first ? 1 : 2); i >= 0; i--) {
		struct level *finer = &run->level[run->n_levels - 1];
		if (c->nodes[i] > 0 && finer->graph.n > 1.3 * c->nodes[i])
			coarser(&run->level[run->n_levels++], finer, c->nodes[i], c->rigid);
	}
}

static struct nricp_conf in_working_units(const struct nricp_conf *conf)
{
	struct nricp_conf c = *conf;
	double *const lengths[] = { &c.stiff[0], &c.stiff[1], &c.turn, &c.welsch[0], &c.welsch[1], &c.rim_reach, &c.rigid, &c.polish };
	for (int i = 0; i < COUNT(lengths); i++)
		*lengths[i] *= working_size;
	return c;
}

static void give(struct nricp_result *out, const struct run *run, const double center[3], double size)
{
	const struct level *l = &run->level[0];
	double square = 0, matched = 0, area = 0;
	for (int i = 0; i < l->graph.n; i++) {
		const struct nricp_match *m = &l->match[i];
		double w = (double)m->weight * l->graph.area[i], d2 = 0;
		for (int k = 0; k < 3; k++) {
			out->place[i][k] = (float)((double)l->points[i].at[k] * size / working_size + center[k]);
			d2 += w > 0 ? pow((double)(m->goal[k] - l->points[i].at[k]), 2) : 0;
		}
		out->confidence[i] = fminf(m->weight, 1);
		out->face[i] = m->face;
		memcpy(out->bary[i], m->bary, sizeof *out->bary);
		square += w * d2;
		matched += w;
		area += l->graph.area[i];
	}
	out->rms = matched > 0 ? sqrt(square / matched) * size / working_size : INFINITY;
	out->covered = area > 0 ? fmin(matched / area, 1) : 0;
}

bool nricp_run(struct nricp_result *out, const struct mesh *moving, const struct mesh *fixed, const double fixed_from_moving[4][4],
               const struct nricp_conf *conf, struct err *err)
{
	static const double same[4][4] = { { 1, 0, 0, 0 }, { 0, 1, 0, 0 }, { 0, 0, 1, 0 }, { 0, 0, 0, 1 } };
	double center[3], size = mesh_size(center, fixed);
	*out = (struct nricp_result){ 0 };
	if (!(size > 0) || !moving->n_faces)
		return err_set(err, "no surface to register");
	struct run *run = mem_new(1, sizeof *run);
	run->conf = in_working_units(conf);
	run->fixed_mesh = nricp_carried(fixed, same, center, working_size / size);
	run->moving = nricp_carried(moving, fixed_from_moving, center, working_size / size);
	nricp_fixed_make(&run->fixed, &run->fixed_mesh);
	build_levels(run);
	deform(run);
	out->place = mem_array((size_t)moving->n_vertices + 1, sizeof *out->place);
	out->confidence = mem_new((size_t)moving->n_vertices + 1, sizeof *out->confidence);
	out->face = mem_new((size_t)moving->n_vertices + 1, sizeof *out->face);
	out->bary = mem_new((size_t)moving->n_vertices + 1, sizeof *out->bary);
	stand(&run->level[0]);
	finish(run);
	give(out, run, center, size);
	for (int i = 0; i < run->n_levels; i++)
		level_free(&run->level[i]);
	nricp_fixed_free(&run->fixed);
	free(run->moving.vertices);
	free(run->fixed_mesh.vertices);
	free(run);
	return true;
}

void nricp_result_free(struct nricp_result *r)
{
	free(r->place);
	free(r->confidence);
	free(r->face);
	free(r->bary);
	*r = (struct nricp_result){ 0 };
}
