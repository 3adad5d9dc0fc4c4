/* Extrapolates motion to untracked vertices by inverse distance weighting (skin paper, eq. 3.5). The paper leaves the distance open; here
 * it is geodesic, along the skin's edges, so that an upper lid does not follow the lower one across the fissure. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "rig/make/make_impl.h"

/* Edges of the mesh, compressed rows: both directions of each. */
struct graph {
	int *start, *to;
	float *length;
};

static float apart(const struct rig *rig, int a, int b)
{
	const float *p = rig->rest[a], *q = rig->rest[b];
	float x = p[0] - q[0], y = p[1] - q[1], z = p[2] - q[2];
	return sqrtf(x * x + y * y + z * z);
}

static struct graph graph_make(const struct rig *rig)
{
	struct graph g = { .start = mem_new((size_t)rig->n + 2, sizeof *g.start) };
	for (int f = 0; f < rig->n_faces; f++)
		for (int k = 0; k < 3; k++)
			g.start[rig->faces[f][k] + 2] += 2;
	for (int i = 2; i <= rig->n + 1; i++)
		g.start[i] += g.start[i - 1];
	size_t edges = (size_t)g.start[rig->n + 1] + 1;
	g.to = mem_new(edges, sizeof *g.to);
	g.length = mem_new(edges, sizeof *g.length);
	for (int f = 0; f < rig->n_faces; f++)
		for (int k = 0; k < 3; k++)
			for (int j = 1; j < 3; j++) {
				int a = rig->faces[f][k], b = rig->faces[f][(k + j) % 3], at = g.start[a + 1]++;
				g.to[at] = b;
				g.length[at] = apart(rig, a, b);
			}
	return g;
}

static void graph_free(struct graph *g)
{
	free(g->start);
	free(g->to);
	free(g->length);
}

/* Dijkstra's priority queue (a binary heap; outdated entries are skipped), and the distances found in this search. */
struct front {
	int n, room;
	struct item {
		float d;
		int vertex;
	} *heap;
	float *best;  // by vertex; INFINITY: not reached
	int n_touched, *touched;
};

static void push(struct front *q, int vertex, float d)
{
	if (!(d < q->best[vertex]))
		return;
	if (q->best[vertex] == INFINITY)
		q->touched[q->n_touched++] = vertex;
	q->best[vertex] = d;
	if (q->n == q->room)
		q->heap = mem_grow(q->heap, (size_t)(q->room = 2 * q->room + 64), sizeof *q->heap);
	int at = q->n++;
	for (; at && q->heap[(at - 1) / 2].d > d; at = (at - 1) / 2)
		q->heap[at] = q->heap[(at - 1) / 2];
	q->heap[at] = (struct item){ d, vertex };
}

static bool pop(struct front *q, struct item *out)
{
	while (q->n) {
		*out = q->heap[0];
		struct item last = q->heap[--q->n];
		int at = 0;
		for (int child; (child = 2 * at + 1) < q->n; at = child) {
			child += child + 1 < q->n && q->heap[child + 1].d < q->heap[child].d;
			if (last.d <= q->heap[child].d)
				break;
			q->heap[at] = q->heap[child];
		}
		q->heap[at] = last;
		if (out->d <= q->best[out->vertex])
			return true;
	}
	return false;
}

static struct front front_new(int n)
{
	struct front q = { .best = mem_array((size_t)n + 1, sizeof *q.best), .touched = mem_array((size_t)n + 1, sizeof *q.touched) };
	for (int i = 0; i < n; i++)
		q.best[i] = INFINITY;
	return q;
}

static void front_reset(struct front *q)
{
	while (q->n_touched)
		q->best[q->touched[--q->n_touched]] = INFINITY;
	q->n = 0;
}

static void front_free(struct front *q)
{
	free(q->heap);
	free(q->best);
	free(q->touched);
}

static void relax(struct front *q, const struct graph *g, struct item at, float reach)
{
	for (int k = g->start[at.vertex]; k < g->start[at.vertex + 1]; k++)
		if (at.d + g->length[k] < reach)
			push(q, g->to[k], at.d + g->length[k]);
}

/* Distance of every vertex from the nearest tracked one along the skin, up to reach. free(). */
static float *from_tracked(const struct rig *rig, const struct graph *g, float reach)
{
	struct front q = front_new(rig->n);
	struct item at;
	for (int i = 0; i < rig->n; i++)
		if (rig->part[i] == RIG_SKIN && rig->source[i] != RIG_EXTRAPOLATED)
			push(&q, i, 0);
	while (pop(&q, &at))
		relax(&q, g, at, reach);
	free(q.heap);
	free(q.touched);
	return q.best;
}

/* The nearest tracked vertices of one: its neighbours, and one more, at whose distance the weights reach zero. */
struct nearest {
	int n, vertex[65];
	float d[65];
};

/* Finds them by geodesic distance, up to `reach`. */
static void along_skin(struct nearest *near, const struct rig *rig, const struct graph *g, struct front *q, int i, int k, float reach)
{
	struct item at;
	near->n = 0;
	push(q, i, 0);
	while (near->n <= k && pop(q, &at)) {
		if (rig->source[at.vertex] != RIG_EXTRAPOLATED && rig->part[at.vertex] == RIG_SKIN) {
			near->vertex[near->n] = at.vertex;
			near->d[near->n++] = at.d;
		}
		relax(q, g, at, reach);
	}
	front_reset(q);
}

/* Finds them by Euclidean distance, for pieces that no edge joins to tracked skin. */
static void through_space(struct nearest *near, const struct rig *rig, int n, const int *tracked, int i, int k)
{
	near->n = 0;
	for (int j = 0; j < n; j++) {
		float d = apart(rig, i, tracked[j]);
		if (near->n == k + 1 && d >= near->d[k])
			continue;
		int at = near->n <= k ? near->n++ : k;
		for (; at && near->d[at - 1] > d; at--) {
			near->d[at] = near->d[at - 1];
			near->vertex[at] = near->vertex[at - 1];
		}
		near->d[at] = d;
		near->vertex[at] = tracked[j];
	}
}

/* Normalised inverse distance weights that reach zero at the last neighbour (Franke and Little 1982): continuous where one neighbour
 * takes another's place. Returns how many there are. */
static int weigh(float weight[64], const struct nearest *near, int k)
{
	int n = near->n <= k ? near->n : k;
	float end = near->n > k ? near->d[k] : INFINITY, sum = 0;
	for (int j = 0; j < n; j++) {
		float d = fmaxf(near->d[j], 1e-4f), w = 1 / d - (isfinite(end) ? 1 / fmaxf(end, 1e-4f) : 0);
		sum += weight[j] = w * w;
	}
	if (!(sum > 0)) {  // all at the same distance
		for (int j = 0; j < n; j++)
			weight[j] = 1;
		sum = (float)n;
	}
	for (int j = 0; j < n; j++)
		weight[j] /= sum;
	return n;
}

static float fade_at(float d, const double fade[2])
{
	double t = (d - fade[0]) / (fade[1] - fade[0]);
	t = t < 0 ? 0 : t > 1 ? 1 : t;
	return (float)(1 - t * t * (3 - 2 * t));
}

struct row {
	int n, column[64];
	float weight[64];
};

static void rows_make(struct row *rows, struct rig *rig, const struct graph *g, const float *reached, const struct rig_conf *conf)
{
	int n_tracked = 0, *tracked = mem_new((size_t)rig->n + 1, sizeof *tracked);
	for (int i = 0; i < rig->n; i++)
		if (rig->part[i] == RIG_SKIN && rig->source[i] != RIG_EXTRAPOLATED)
			tracked[n_tracked++] = i;
#pragma omp parallel
	{
		struct front q = front_new(rig->n);
#pragma omp for schedule(dynamic, 64)
		for (int i = 0; i < rig->n; i++) {
			struct nearest near;
			struct row *row = &rows[i];
			rig->fade[i] = 1;
			*row = (struct row){ 1, { i }, { 1 } };
			if (rig->source[i] != RIG_EXTRAPOLATED || rig_is_globe(rig->part[i]) || !n_tracked)
				continue;
			if (reached[i] < INFINITY)
				along_skin(&near, rig, g, &q, i, conf->neighbours, 2 * (float)conf->fade[1]);
			else
				through_space(&near, rig, n_tracked, tracked, i, conf->neighbours);
			row->n = weigh(row->weight, &near, conf->neighbours);
			memcpy(row->column, near.vertex, (size_t)row->n * sizeof *row->column);
			rig->fade[i] = fade_at(near.d[0], conf->fade);
		}
		front_free(&q);
	}
	free(tracked);
}

void rig_spread(struct rig *rig, const struct rig_conf *conf)
{
	struct graph g = graph_make(rig);
	float *reached = from_tracked(rig, &g, (float)conf->fade[1]);
	struct row *rows = mem_new((size_t)rig->n + 1, sizeof *rows);
	rows_make(rows, rig, &g, reached, conf);
	int total = 0;
	for (int i = 0; i < rig->n; i++)
		total += rows[i].n;
	rig->bplus.start = mem_new((size_t)rig->n + 1, sizeof *rig->bplus.start);
	rig->bplus.column = mem_new((size_t)total + 1, sizeof *rig->bplus.column);
	rig->bplus.weight = mem_new((size_t)total + 1, sizeof *rig->bplus.weight);
	for (int i = 0; i < rig->n; i++) {
		int at = rig->bplus.start[i];
		memcpy(rig->bplus.column + at, rows[i].column, (size_t)rows[i].n * sizeof(int32_t));
		memcpy(rig->bplus.weight + at, rows[i].weight, (size_t)rows[i].n * sizeof(float));
		rig->bplus.start[i + 1] = at + rows[i].n;
	}
	free(rows);
	free(reached);
	graph_free(&g);
}
