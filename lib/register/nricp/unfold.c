#include "register/nricp/unfold.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"

/* A triangle is folded when the cosine between its normal at rest and now is smaller. */
static const double upright = 0.35;

static void face_normal(double n[3], const float *a, const float *b, const float *c)
{
	double e[3], g[3];
	for (int k = 0; k < 3; k++) {
		e[k] = (double)b[k] - (double)a[k];
		g[k] = (double)c[k] - (double)a[k];
	}
	n[0] = e[1] * g[2] - e[2] * g[1];
	n[1] = e[2] * g[0] - e[0] * g[2];
	n[2] = e[0] * g[1] - e[1] * g[0];
}

struct unfold {
	const struct mesh *rest;
	const struct nricp_graph *graph;
	double (*t)[4];    // displacements
	uint8_t *region;   // [vertices] those that may move
	int32_t *face;     // of the region
	int n;
};

static bool is_folded(const struct unfold *u, const int32_t f[3])
{
	double was[3], is[3], dot = 0, was2 = 0, is2 = 0;
	float at[3][3];
	for (int i = 0; i < 3; i++)
		for (int k = 0; k < 3; k++)
			at[i][k] = (float)(u->graph->place[f[i]][k] + u->t[f[i]][k]);
	face_normal(was, u->rest->vertices[f[0]], u->rest->vertices[f[1]], u->rest->vertices[f[2]]);
	face_normal(is, at[0], at[1], at[2]);
	for (int k = 0; k < 3; k++) {
		dot += was[k] * is[k];
		was2 += was[k] * was[k];
		is2 += is[k] * is[k];
	}
	return dot < upright * sqrt(was2 * is2);
}

/* Marks neighbours, ring after ring; marked[] is 1 at the start. */
static void grow(uint8_t *marked, const struct nricp_graph *g, int rings)
{
	for (int ring = 1; ring <= rings; ring++)
		for (int i = 0; i < g->n; i++)
			for (int32_t e = g->start[i]; e < g->start[i + 1] && marked[i] == ring; e++)
				if (!marked[g->neighbour[e]])
					marked[g->neighbour[e]] = (uint8_t)(ring + 1);
}

/* Places a triangle about its middle by the mean affine map of its corners. */
static void lay(struct unfold *u, const int32_t f[3])
{
	const struct nricp_graph *g = u->graph;
	double map[3][3] = { 0 }, rest[3] = { 0 }, t[3] = { 0 };
	for (int i = 0; i < 3; i++) {
		double a[3][3];
		nricp_graph_affine(a, g, f[i], (const double(*)[4])u->t, 0);
		for (int k = 0; k < 9; k++)
			(&map[0][0])[k] += (&a[0][0])[k] / 3;
		for (int k = 0; k < 3; k++) {
			rest[k] += g->place[f[i]][k] / 3;
			t[k] += u->t[f[i]][k] / 3;
		}
	}
	for (int i = 0; i < 3; i++)
		for (int r = 0; r < 3; r++) {
			u->t[f[i]][r] = t[r];
			for (int c = 0; c < 3; c++)
				u->t[f[i]][r] += map[r][c] * (g->place[f[i]][c] - rest[c]);
		}
}

/* Replaces displacements by the mean of the neighbours' (a Gauss-Seidel sweep of the Laplace equation). */
static void relax(struct unfold *u, const uint8_t *marked)
{
	const struct nricp_graph *g = u->graph;
	for (int i = 0; i < g->n; i++) {
		int32_t degree = g->start[i + 1] - g->start[i];
		if (!marked[i] || !u->region[i] || !degree)
			continue;
		double sum[3] = { 0 };
		for (int32_t e = g->start[i]; e < g->start[i + 1]; e++)
			for (int k = 0; k < 3; k++)
				sum[k] += u->t[g->neighbour[e]][k];
		for (int k = 0; k < 3; k++)
			u->t[i][k] = sum[k] / degree;
	}
}

/* Finds the folded triangles of the whole mesh; the region is `rings` rings of vertices around them. Returns how many. */
static int find_region(struct unfold *u, int rings)
{
	int folded = 0;
	memset(u->region, 0, (size_t)u->graph->n);
	for (int f = 0; f < u->rest->n_faces; f++)
		if (is_folded(u, u->rest->faces[f])) {
			folded++;
			for (int k = 0; k < 3; k++)
				u->region[u->rest->faces[f][k]] = 1;
		}
	u->n = 0;
	if (!folded)
		return 0;
	grow(u->region, u->graph, rings);
	for (int f = 0; f < u->rest->n_faces; f++) {
		const int32_t *v = u->rest->faces[f];
		if (u->region[v[0]] || u->region[v[1]] || u->region[v[2]])
			u->face[u->n++] = f;
	}
	return folded;
}

/* Places each folded triangle by itself; what stays folded is smoothed with a growing neighbourhood. */
static void unfold_region(struct unfold *u, int rings)
{
	enum { ALONE = 12, SWEEPS = 4 };
	uint8_t *marked = mem_new((size_t)u->graph->n + 1, 1);
	for (int pass = 0, folded = 1; pass < ALONE + rings && folded; pass++) {
		folded = 0;
		memset(marked, 0, (size_t)u->graph->n);
		for (int i = 0; i < u->n; i++) {
			const int32_t *f = u->rest->faces[u->face[i]];
			if (!is_folded(u, f))
				continue;
			folded++;
			if (pass < ALONE)
				lay(u, f);
			for (int k = 0; k < 3; k++)
				marked[f[k]] = 1;
		}
		if (pass >= ALONE && folded) {
			grow(marked, u->graph, pass - ALONE);
			for (int sweep = 0; sweep < SWEEPS; sweep++)
				relax(u, marked);
		}
	}
	free(marked);
}

int nricp_unfold(struct nricp_point *points, const struct mesh *rest, const struct nricp_graph *graph)
{
	enum { TRIES = 6, RINGS = 4 };
	struct unfold u = { .rest = rest, .graph = graph };
	int folded = 0;
	u.t = mem_array((size_t)graph->n + 1, sizeof *u.t);
	u.region = mem_new((size_t)graph->n + 1, 1);
	u.face = mem_array((size_t)rest->n_faces + 1, sizeof *u.face);
	for (int i = 0; i < graph->n; i++)
		for (int k = 0; k < 4; k++)
			u.t[i][k] = k < 3 ? (double)points[i].at[k] - graph->place[i][k] : 0;
	for (int i = 0; i <= TRIES; i++) {
		folded = find_region(&u, RINGS * (i + 1));
		if (!folded || i == TRIES)
			break;
		unfold_region(&u, RINGS * (i + 1));
	}
	for (int i = 0; i < graph->n; i++)
		for (int k = 0; k < 3; k++)
			points[i].at[k] = (float)(graph->place[i][k] + u.t[i][k]);
	free(u.t);
	free(u.region);
	free(u.face);
	return folded;
}
