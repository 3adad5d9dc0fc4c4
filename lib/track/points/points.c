#include "track/points/points.h"

#include <math.h>
#include <stdlib.h>

#include "base/mem.h"

void skin_points_free(struct skin_points *points)
{
	free(points->at);
	free(points->first);
	free(points->near);
	*points = (struct skin_points){ 0 };
}

struct candidate {
	double d2;
	int to;
};

static int nearer(const void *a, const void *b)
{
	const struct candidate *p = a, *q = b;
	return p->d2 != q->d2 ? (p->d2 > q->d2) - (p->d2 < q->d2) : p->to - q->to;
}

/* Adds the points one edge away from `of` that are not marked with `mark` yet. */
static int widen(struct candidate *out, int n, const int *first, const int *link, int of, int *marked, int mark)
{
	for (int k = first[of]; k < first[of + 1]; k++)
		if (marked[link[k]] != mark) {
			marked[link[k]] = mark;
			out[n++].to = link[k];
		}
	return n;
}

static void adjacency(int **first, int **link, int n, int n_edges, const int (*edges)[2])
{
	*first = mem_new((size_t)n + 2, sizeof **first);
	*link = mem_new(2 * (size_t)n_edges + 1, sizeof **link);
	for (int e = 0; e < n_edges; e++)
		for (int k = 0; k < 2; k++)
			(*first)[edges[e][k] + 2]++;
	for (int i = 0; i < n; i++)
		(*first)[i + 2] += (*first)[i + 1];
	for (int e = 0; e < n_edges; e++)
		for (int k = 0; k < 2; k++)
			(*link)[(*first)[edges[e][k] + 1]++] = edges[e][1 - k];
}

void skin_points_join(struct skin_points *p, int n_edges, const int (*edges)[2], int count)
{
	int n = p->n, *first, *link, *marked = mem_new((size_t)n + 1, sizeof *marked);
	struct candidate *c = mem_new((size_t)n + 1, sizeof *c);
	count = count > SKIN_NEAR_MAX ? SKIN_NEAR_MAX : count;
	adjacency(&first, &link, n, n_edges, edges);
	p->first = mem_new((size_t)n + 1, sizeof *p->first);
	p->near = mem_new((size_t)n * (size_t)count + 1, sizeof *p->near);
	for (int i = 0; i < n; i++) {
		int m = 0;
		marked[i] = i + 1;
		if (n_edges) {
			m = widen(c, m, first, link, i, marked, i + 1);
			for (int ring = 0, from = 0; ring < 2; ring++)
				for (int k = from, end = m; k < end; k++, from = end)
					m = widen(c, m, first, link, c[k].to, marked, i + 1);
		} else {
			for (int j = 0; j < n; j++)
				if (j != i)
					c[m++].to = j;
		}
		for (int k = 0; k < m; k++)
			c[k].d2 = pow(p->at[c[k].to][0] - p->at[i][0], 2) + pow(p->at[c[k].to][1] - p->at[i][1], 2);
		qsort(c, (size_t)m, sizeof *c, nearer);
		p->first[i + 1] = p->first[i];
		for (int k = 0; k < m && k < count; k++)
			p->near[p->first[i + 1]++] = c[k].to;
	}
	free(first);
	free(link);
	free(marked);
	free(c);
}
