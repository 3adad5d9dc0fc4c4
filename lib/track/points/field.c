/* Neighbours on the mesh: who they are, and what they say. */
#include <math.h>
#include <stdlib.h>

#include "base/mem.h"
#include "math/stats.h"
#include "track/points/track_impl.h"

enum { NEAR_MAX = 32 };

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
	count = count > NEAR_MAX ? NEAR_MAX : count;
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

/* Where neighbour j sees point i: its own warp carried on. */
static void seen_from(double out[2], const struct skin_track *t, int i, int j)
{
	const struct patch_warp *w = &t->point[j].warp;
	double d[2] = { t->points.at[i][0] - t->points.at[j][0], t->points.at[i][1] - t->points.at[j][1] };
	for (int r = 0; r < 2; r++)
		out[r] = w->at[r] + w->A[r][0] * d[0] + w->A[r][1] * d[1];
}

static double pow2(double x)
{
	return x * x;
}

/* A robust mean: from the median on, with Tukey's weights; near neighbours count more. */
static void ask(struct skin_field *f, const struct skin_track *t, int i)
{
	double at[NEAR_MAX][2], x[NEAR_MAX], weight[NEAR_MAX], mid[2];
	int who[NEAR_MAX], n = 0;
	*f = (struct skin_field){ 0 };
	for (int k = t->points.first[i]; k < t->points.first[i + 1] && n < NEAR_MAX; k++)
		if (t->point[t->points.near[k]].seen) {
			who[n] = t->points.near[k];
			seen_from(at[n], t, i, who[n]);
			n++;
		}
	if (n <= 0)
		return;
	for (int r = 0; r < 2; r++) {
		for (int k = 0; k < n; k++)
			x[k] = at[k][r];
		mid[r] = stats_median(n, x);
	}
	for (int k = 0; k < n; k++)
		x[k] = sqrt(pow2(at[k][0] - mid[0]) + pow2(at[k][1] - mid[1]));
	double scale = fmax(3 * stats_median(n, x), 0.5), sum = 0, far = 0;
	for (int k = 0; k < n; k++) {
		double r = sqrt(pow2(at[k][0] - mid[0]) + pow2(at[k][1] - mid[1])) / scale, d2 = 0;
		for (int c = 0; c < 2; c++)
			d2 += pow2(t->points.at[i][c] - t->points.at[who[k]][c]);
		weight[k] = r < 1 ? (1 - r * r) * (1 - r * r) / (d2 + 25) : 0;
		sum += weight[k];
	}
	for (int k = 0; k < n; k++) {
		double w = weight[k] / sum;
		for (int r = 0; r < 2; r++) {
			f->warp.at[r] += w * at[k][r];
			for (int c = 0; c < 2; c++)
				f->warp.A[r][c] += w * t->point[who[k]].warp.A[r][c];
		}
	}
	for (int k = 0; k < n; k++)
		far += weight[k] / sum * (pow2(at[k][0] - f->warp.at[0]) + pow2(at[k][1] - f->warp.at[1]));
	f->spread = sqrt(far);
	f->n = n;
}

void skin_track_ask(struct skin_track *t)
{
#pragma omp parallel for schedule(static)
	for (int i = 0; i < t->points.n; i++)
		ask(&t->field[i], t, i);
}
