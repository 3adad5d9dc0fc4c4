#include "register/nricp/graph.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "register/nricp/energy.h"
#include "register/nricp/sample.h"

void nricp_graph_free(struct nricp_graph *g)
{
	void *const all[] = { g->place,    g->area,    g->spacing2, g->start, g->neighbour, g->r_start,
		                  g->r_column, g->r_value, g->star,     g->ridge, g->parent,    g->row };
	for (int i = 0; i < COUNT(all); i++)
		free(all[i]);
	*g = (struct nricp_graph){ 0 };
}

/* Edges of the coarser graph: between the parents of the two ends of each edge of the finer. */
static void join_owners(struct nricp_graph *out, const struct nricp_graph *fine)
{
	int n = out->n;
	int32_t *first = mem_new((size_t)n + 1, sizeof *first), *member = mem_array((size_t)fine->n + 1, sizeof *member);
	int32_t *seen = mem_array((size_t)n + 1, sizeof *seen), room = 8 * n + 64, edges = 0;
	out->start = mem_new((size_t)n + 1, sizeof *out->start);
	out->neighbour = mem_array((size_t)room, sizeof *out->neighbour);
	for (int i = 0; i < fine->n; i++)
		first[out->parent[i] + 1]++;
	for (int i = 0; i < n; i++) {
		first[i + 1] += first[i];
		seen[i] = -1;
	}
	for (int i = 0; i < fine->n; i++)
		member[first[out->parent[i]]++] = i;  // first[p] ends as the end of p
	for (int p = 0; p < n; p++) {
		for (int32_t m = p ? first[p - 1] : 0; m < first[p]; m++)
			for (int32_t e = fine->start[member[m]]; e < fine->start[member[m] + 1]; e++) {
				int32_t q = out->parent[fine->neighbour[e]];
				if (q == p || seen[q] == p)
					continue;
				seen[q] = p;
				if (edges == room)
					out->neighbour = mem_grow(out->neighbour, (size_t)(room *= 2), sizeof *out->neighbour);
				out->neighbour[edges++] = q;
			}
		out->start[p + 1] = edges;
	}
	free(first);
	free(member);
	free(seen);
}

void nricp_graph_make(struct nricp_graph *out, int n, const double (*place)[4], const double *area, const int32_t *start,
                      const int32_t *neighbour, double rigidity)
{
	*out = (struct nricp_graph){ .n = n };
	out->place = mem_array((size_t)n + 1, sizeof *out->place);
	out->area = mem_array((size_t)n + 1, sizeof *out->area);
	out->start = mem_array((size_t)n + 1, sizeof *out->start);
	out->neighbour = mem_array((size_t)start[n] + 1, sizeof *out->neighbour);
	memcpy(out->place, place, (size_t)n * sizeof *place);
	memcpy(out->area, area, (size_t)n * sizeof *area);
	memcpy(out->start, start, ((size_t)n + 1) * sizeof *start);
	memcpy(out->neighbour, neighbour, (size_t)start[n] * sizeof *neighbour);
	nricp_graph_energy(out, rigidity);
}

void nricp_graph_coarser(struct nricp_graph *out, const struct nricp_graph *fine, int nodes, double rigidity)
{
	*out = (struct nricp_graph){ 0 };
	out->parent = mem_array((size_t)fine->n + 1, sizeof *out->parent);
	out->row = mem_array((size_t)fine->n + 1, sizeof *out->row);
	out->n = nricp_sample(out->parent, out->row, fine, nodes);
	out->place = mem_array((size_t)out->n + 1, sizeof *out->place);
	out->area = mem_new((size_t)out->n + 1, sizeof *out->area);
	for (int i = 0; i < out->n; i++)
		memcpy(out->place[i], fine->place[out->row[i]], sizeof *out->place);
	for (int i = 0; i < fine->n; i++)
		out->area[out->parent[i]] += fine->area[i];
	join_owners(out, fine);
	nricp_graph_energy(out, rigidity);
}

void nricp_graph_affine(double affine[3][3], const struct nricp_graph *g, int i, const double (*t)[4], const double turn[9])
{
	const double *m = g->ridge + 9 * (size_t)i;
	for (int r = 0; r < 3; r++)
		for (int c = 0; c < 3; c++)
			affine[r][c] = turn ? turn[3 * r] * m[c] + turn[3 * r + 1] * m[3 + c] + turn[3 * r + 2] * m[6 + c] : 0;
	for (int32_t e = g->start[i]; e < g->start[i + 1]; e++) {
		const double *to = t[g->neighbour[e]], *s = g->star + 3 * (size_t)e;
		for (int r = 0; r < 3; r++)
			for (int c = 0; c < 3; c++)
				affine[r][c] += (to[r] - t[i][r]) * s[c];
	}
}

/* The rotation nearest to a (det a > 0), by Higham's iteration, which converges quadratically: a <- (a + a^-T) / 2. */
static void nearest_rotation(double a[3][3])
{
	for (int step = 0; step < 20; step++) {
		double cof[3][3], change = 0;
		for (int i = 0; i < 3; i++)
			for (int j = 0; j < 3; j++) {
				int p = (i + 1) % 3, q = (i + 2) % 3, r = (j + 1) % 3, s = (j + 2) % 3;
				cof[i][j] = a[p][r] * a[q][s] - a[p][s] * a[q][r];
			}
		double det = a[0][0] * cof[0][0] + a[0][1] * cof[0][1] + a[0][2] * cof[0][2];
		if (!(det > 1e-3)) {  // inverted or flat: no nearest rotation, take the identity
			memset(a, 0, 9 * sizeof(double));
			a[0][0] = a[1][1] = a[2][2] = 1;
			return;
		}
		double half = 0.5 / det;
		for (int i = 0; i < 9; i++) {
			double next = 0.5 * (&a[0][0])[i] + half * (&cof[0][0])[i];
			change += fabs(next - (&a[0][0])[i]);
			(&a[0][0])[i] = next;
		}
		if (change < 1e-9)
			return;
	}
}

void nricp_graph_turns(double (*turn)[9], const struct nricp_graph *g, const double (*t)[4], double growth)
{
	for (int i = 0; i < g->n; i++) {
		double a[3][3];
		nricp_graph_affine(a, g, i, t, turn[i]);
		for (int k = 0; k < 3; k++)
			a[k][k] += 1;
		double was[3][3], grown = 0;
		memcpy(was, a, sizeof was);
		nearest_rotation(a);
		for (int k = 0; k < 9; k++)
			grown += (&a[0][0])[k] * (&was[0][0])[k] / 3;
		for (int k = 0; k < 9; k++)
			(&a[0][0])[k] *= 1 + growth * (grown - 1);
		for (int k = 0; k < 3; k++)
			a[k][k] -= 1;
		memcpy(turn[i], a, sizeof *turn);
	}
}

/* Weight of a node at `a` in the blend at p; falls to 0 at the distance sqrt(reach2). */
static double blend(const double p[4], const double a[4], double reach2)
{
	double d2 = 0;
	for (int k = 0; k < 3; k++)
		d2 += (p[k] - a[k]) * (p[k] - a[k]);
	double w = 1 - d2 / reach2;
	return w > 0 ? w * w : 0;
}

void nricp_graph_spread(double (*fine_t)[4], const struct nricp_graph *fine, const struct nricp_graph *g, const double (*t)[4])
{
	double (*affine)[3][3] = mem_array((size_t)g->n + 1, sizeof *affine);
	for (int i = 0; i < g->n; i++)
		nricp_graph_affine(affine[i], g, i, t, 0);
	for (int v = 0; v < fine->n; v++) {
		int32_t own = g->parent[v];
		double sum[4] = { 0 }, weight = 0, reach2 = 4 * g->spacing2[own];
		const double *p = fine->place[v];
		for (int32_t e = g->start[own] - 1; e < g->start[own + 1]; e++) {
			int32_t j = e < g->start[own] ? own : g->neighbour[e];
			double w = j == own && !(reach2 > 0) ? 1 : blend(p, g->place[j], reach2);
			w += j == own ? 1e-6 : 0;
			for (int r = 0; r < 3; r++) {
				double d = t[j][r];
				for (int c = 0; c < 3; c++)
					d += affine[j][r][c] * (p[c] - g->place[j][c]);
				sum[r] += w * d;
			}
			weight += w;
		}
		for (int r = 0; r < 4; r++)
			fine_t[v][r] = sum[r] / weight;
	}
	free(affine);
}
