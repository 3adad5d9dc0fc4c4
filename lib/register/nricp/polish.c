#include "register/nricp/polish.h"

#include <math.h>
#include <stdlib.h>

#include "base/mem.h"

/* (weight + length^2 Laplacian) s = weight offset, by conjugate gradients preconditioned with the diagonal; the matrix is close to the
 * identity, so few steps are enough. All edges have the weight 1 / sqrt(3) that cotangents have on equilateral triangles. */
struct screened {
	const struct nricp_graph *graph;
	double edge;       // length^2 / sqrt(3)
	double *weight, *s, *r, *p, *q, *inverse;
};

static void times(double *y, const struct screened *e, const double *x)
{
	const struct nricp_graph *g = e->graph;
	for (int i = 0; i < g->n; i++) {
		double sum = 0;
		for (int32_t k = g->start[i]; k < g->start[i + 1]; k++)
			sum += x[i] - x[g->neighbour[k]];
		y[i] = e->weight[i] * x[i] + e->edge * sum;
	}
}

static void solve(struct screened *e, const double *offset)
{
	enum { STEPS = 20 };
	int n = e->graph->n;
	double rz = 0, stop;
	for (int i = 0; i < n; i++) {
		double d = e->weight[i] + e->edge * (e->graph->start[i + 1] - e->graph->start[i]);
		e->inverse[i] = d > 0 ? 1 / d : 0;
		e->s[i] = 0;
		e->r[i] = e->weight[i] * offset[i];
		e->p[i] = e->inverse[i] * e->r[i];
		rz += e->r[i] * e->p[i];
	}
	stop = 1e-6 * rz;
	for (int step = 0; step < STEPS && rz > stop; step++) {
		double pq = 0, next = 0;
		times(e->q, e, e->p);
		for (int i = 0; i < n; i++)
			pq += e->p[i] * e->q[i];
		if (!(pq > 0))
			break;
		for (int i = 0; i < n; i++) {
			e->s[i] += rz / pq * e->p[i];
			e->r[i] -= rz / pq * e->q[i];
			next += e->r[i] * e->r[i] * e->inverse[i];
		}
		for (int i = 0; i < n; i++)
			e->p[i] = e->inverse[i] * e->r[i] + next / rz * e->p[i];
		rz = next;
	}
}

void nricp_polish(struct nricp_point *points, struct nricp_match *match, const struct nricp_graph *graph, const struct nricp_fixed *fixed,
                  const struct nricp_conf *conf, double length)
{
	size_t n = (size_t)graph->n + 1;
	double *room = mem_array(7 * n, sizeof *room), *offset = room + 6 * n;
	struct screened e = { graph, length * length / sqrt(3), room, room + n, room + 2 * n, room + 3 * n, room + 4 * n, room + 5 * n };
	for (int round = 0; round < conf->polish_rounds; round++) {
		nricp_match_all(match, graph->n, points, fixed, conf, conf->welsch[1]);
		for (int i = 0; i < graph->n; i++) {
			const struct nricp_match *m = &match[i];
			double across = 0;
			for (int k = 0; k < 3; k++)
				across += (double)points[i].normal[k] * (double)(m->goal[k] - points[i].at[k]);
			e.weight[i] = m->on_rim ? 0 : (double)m->weight * graph->area[i];
			offset[i] = e.weight[i] > 0 ? across : 0;
		}
		solve(&e, offset);
		for (int i = 0; i < graph->n; i++)
			for (int k = 0; k < 3; k++)
				points[i].at[k] += (float)e.s[i] * points[i].normal[k];
	}
	free(room);
}
