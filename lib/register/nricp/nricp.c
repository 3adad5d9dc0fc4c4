#include "register/nricp/nricp.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "register/nricp/energy.h"
#include "register/nricp/frame.h"
#include "register/nricp/level.h"
#include "register/nricp/polish.h"
#include "register/nricp/unfold.h"

static const double working_size = 100;  // the fixed mesh is scaled to this size, which suits single precision

struct run {
	struct mesh moving, fixed_mesh;  // copies in working units; faces are the caller's
	struct nricp_fixed fixed;
	struct nricp_conf conf;
	struct nricp_level level[NRICP_LEVELS + 1];
	int n_levels;                    // level[0] has all vertices, each further one is coarser
	enum { MAYBE, YES, NO } mirror;  // whether the moving mesh is symmetric; MAYBE: not looked at yet
	struct nricp_plane plane;        // of symmetry
	double own[4][4];                // working frame from the moving mesh's own
	int first;                       // the finest level solved: 1 with too many vertices, level[0] is then only polished
};

/* Whether the symmetry prior is needed: more than `much` of the moving mesh is unmatched, and it is symmetric. Then l->twins is made. */
static bool is_lacking(struct run *run, struct nricp_level *l)
{
	static const double much = 0.05, tolerance = 0.002 * working_size;
	double lacking = 0, all = 0;
	for (int i = 0; i < l->graph.n; i++) {
		lacking += l->match[i].weight > 0 ? 0 : l->graph.area[i];
		all += l->graph.area[i];
	}
	if (run->mirror == NO || !(run->conf.mirror > 0) || !(lacking > much * all))
		return false;
	if (run->mirror == MAYBE)
		run->mirror = nricp_plane_find(&run->plane, &run->moving, (const double(*)[4])run->own, tolerance) ? YES : NO;
	if (run->mirror == YES && !l->twins.node)
		nricp_twins_make(&l->twins, &l->graph, &run->plane);
	return run->mirror == YES;
}

/* Rounds of matching and solving on one level. first, total: numbers of its first round and of all rounds, for the schedules of
 * stiffness and weight. */
static void one_level(struct run *run, struct nricp_level *l, int rounds, int first, int total, bool direct)
{
	const struct nricp_conf *c = &run->conf;
	double last = c->stiff[1] + c->noise * run->fixed.noise;
	struct nricp_solver *solver = nricp_solver_new(&l->graph, direct, 60, 1e-2);
	for (int i = 0; i < rounds; i++) {
		double at = total > 1 ? (double)(first + i) / (total - 1) : 1;
		double stiff = c->stiff[0] * pow(last / c->stiff[0], at);
		double scale = c->welsch[0] * pow(c->welsch[1] / c->welsch[0], at);
		nricp_level_stand(l);
		nricp_match_all(l->match, l->graph.n, l->points, &run->fixed, c, scale);
		nricp_level_ask(l, c);
		if (is_lacking(run, l))
			nricp_twins_ask(&l->data, &l->twins, &l->graph, l->points, l->match, (const double(*)[3][3])l->affine, c->mirror);
		nricp_graph_turns(l->turn, &l->graph, (const double(*)[4])l->t, c->growth);
		nricp_graph_pull(l->pull, &l->graph, (const double(*)[9])l->turn);
		nricp_solver_run(solver, l->t, &l->data, (const double(*)[4])l->pull, pow(stiff, 4));
	}
	nricp_solver_free(solver);
}

/* Solves the levels from coarse to fine; each starts from the displacements of the one before. */
static void deform(struct run *run)
{
	int total = 0, done = 0, last = run->n_levels - 1;
	for (int i = last; i >= run->first; i--)
		total += run->conf.rounds[NRICP_LEVELS - 1 - i + run->first];
	for (int i = last; i >= 0; i--) {
		struct nricp_level *l = &run->level[i];
		int rounds = i >= run->first ? run->conf.rounds[NRICP_LEVELS - 1 - i + run->first] : 0;
		if (i < last) {
			nricp_graph_spread(l->t, &l->graph, &l[1].graph, (const double(*)[4])l[1].t);
			for (int v = 0; v < l->graph.n; v++)  // where the search for matches begins
				l->match[v].face = l[1].match[l[1].graph.parent[v]].face;
		}
		nricp_graph_turns(l->turn, &l->graph, (const double(*)[4])l->t, run->conf.growth);
		one_level(run, l, rounds, done, total, i == last);
		done += rounds;
	}
}

static void finish(struct run *run)
{
	struct nricp_level *l = &run->level[0];
	const struct nricp_conf *c = &run->conf;
	nricp_polish(l->points, l->match, &l->graph, &run->fixed, c, c->polish + c->polish_noise * run->fixed.noise);
	nricp_unfold(l->points, &run->moving, &l->graph);
	nricp_match_all(l->match, l->graph.n, l->points, &run->fixed, c, c->welsch[1]);
}

static void build_levels(struct run *run)
{
	const struct nricp_conf *c = &run->conf;
	nricp_level_finest(&run->level[0], &run->moving, c->rigid);
	run->n_levels = 1;
	run->first = run->level[0].graph.n > 1.3 * c->nodes[NRICP_LEVELS - 1];
	for (int i = NRICP_LEVELS - (run->first ? 1 : 2); i >= 0; i--) {
		struct nricp_level *finer = &run->level[run->n_levels - 1];
		if (c->nodes[i] > 0 && finer->graph.n > 1.3 * c->nodes[i])
			nricp_level_coarser(&run->level[run->n_levels++], finer, c->nodes[i], c->rigid);
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

/* The result, back in the meshes' own unit. */
static void give(struct nricp_result *out, const struct run *run, const double center[3], double size)
{
	const struct nricp_level *l = &run->level[0];
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
	for (int r = 0; r < 3; r++)
		for (int c = 0; c < 4; c++)
			run->own[r][c] = (fixed_from_moving[r][c] - (c == 3 ? center[r] : 0)) * working_size / size;
	nricp_fixed_make(&run->fixed, &run->fixed_mesh);
	build_levels(run);
	deform(run);
	out->place = mem_array((size_t)moving->n_vertices + 1, sizeof *out->place);
	out->confidence = mem_new((size_t)moving->n_vertices + 1, sizeof *out->confidence);
	out->face = mem_new((size_t)moving->n_vertices + 1, sizeof *out->face);
	out->bary = mem_new((size_t)moving->n_vertices + 1, sizeof *out->bary);
	nricp_level_stand(&run->level[0]);
	finish(run);
	give(out, run, center, size);
	for (int i = 0; i < run->n_levels; i++)
		nricp_level_free(&run->level[i]);
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
