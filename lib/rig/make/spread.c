/* Extrapolates motion to untracked vertices by inverse distance weighting (skin paper, eq. 3.5). The paper leaves the distance open; here
 * it is geodesic, along the skin's edges, so that an upper lid does not follow the lower one across the fissure. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "mesh/kdtree.h"
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

/* A tracked vertex, and how far it is along the skin. */
struct label {
	float d;
	int source;
};

/* Dijkstra's priority queue, a binary heap: what would be the next label of a vertex. */
struct front {
	int n, room;
	struct item {
		struct label label;
		int vertex;
	} *heap;
};

static void push(struct front *q, int vertex, struct label label)
{
	if (q->n == q->room)
		q->heap = mem_grow(q->heap, (size_t)(q->room = 2 * q->room + 64), sizeof *q->heap);
	int at = q->n++;
	for (; at && q->heap[(at - 1) / 2].label.d > label.d; at = (at - 1) / 2)
		q->heap[at] = q->heap[(at - 1) / 2];
	q->heap[at] = (struct item){ label, vertex };
}

static struct item pop(struct front *q)
{
	const struct item top = q->heap[0], last = q->heap[--q->n];
	int at = 0;
	for (int child; (child = 2 * at + 1) < q->n; at = child) {
		child += child + 1 < q->n && q->heap[child + 1].label.d < q->heap[child].label.d;
		if (last.label.d <= q->heap[child].label.d)
			break;
		q->heap[at] = q->heap[child];
	}
	q->heap[at] = last;
	return top;
}

/* The nearest tracked vertices of every vertex along the skin, up to a distance: at most `most` each, nearest first. */
struct labels {
	int most, *n;
	struct label *of;  // [vertices][most]
};

static bool has(const struct labels *l, int vertex, int source)
{
	for (int i = 0; i < l->n[vertex]; i++)
		if (l->of[(size_t)vertex * (size_t)l->most + (size_t)i].source == source)
			return true;
	return false;
}

/* One search from all tracked vertices at once: a path to one of a vertex's nearest leads over vertices of whose nearest it is, too. */
static struct labels labels_make(const struct rig *rig, const struct graph *g, int most, float reach)
{
	struct labels l = { .most = most, .n = mem_new((size_t)rig->n + 1, sizeof *l.n), .of = mem_array((size_t)rig->n * (size_t)most + 1, sizeof *l.of) };
	struct front q = { 0 };
	for (int i = 0; i < rig->n; i++)
		if (rig->part[i] == RIG_SKIN && rig->source[i] != RIG_EXTRAPOLATED)
			push(&q, i, (struct label){ 0, i });
	while (q.n) {
		const struct item at = pop(&q);
		if (l.n[at.vertex] == most || has(&l, at.vertex, at.label.source))
			continue;
		l.of[(size_t)at.vertex * (size_t)most + (size_t)l.n[at.vertex]++] = at.label;
		for (int k = g->start[at.vertex]; k < g->start[at.vertex + 1]; k++) {
			const struct label next = { at.label.d + g->length[k], at.label.source };
			if (next.d < reach && l.n[g->to[k]] < most && !has(&l, g->to[k], next.source))
				push(&q, g->to[k], next);
		}
	}
	free(q.heap);
	return l;
}

static void labels_free(struct labels *l)
{
	free(l->n);
	free(l->of);
}

/* The nearest tracked vertices of one: its neighbours, and one more, at whose distance the weights reach zero. */
struct nearest {
	int n, vertex[65];
	float d[65];
};

static void along_skin(struct nearest *near, const struct labels *l, int i)
{
	near->n = l->n[i];
	for (int j = 0; j < near->n; j++) {
		const struct label *label = &l->of[(size_t)i * (size_t)l->most + (size_t)j];
		near->vertex[j] = label->source;
		near->d[j] = label->d;
	}
}

/* All tracked vertices by their place in space. */
struct tracked {
	int n, *vertex;
	struct kdtree *tree;  // null: there are none
};

static struct tracked tracked_make(const struct rig *rig)
{
	struct tracked t = { .vertex = mem_new((size_t)rig->n + 1, sizeof *t.vertex) };
	float *at = mem_array((size_t)rig->n + 1, 3 * sizeof *at);
	for (int i = 0; i < rig->n; i++)
		if (rig->part[i] == RIG_SKIN && rig->source[i] != RIG_EXTRAPOLATED) {
			memcpy(at + 3 * (size_t)t.n, rig->rest[i], 3 * sizeof *at);
			t.vertex[t.n++] = i;
		}
	if (t.n)
		t.tree = kdtree_new(t.n, 3, at);
	free(at);
	return t;
}

static void tracked_free(struct tracked *t)
{
	free(t->vertex);
	if (t->tree)
		kdtree_free(t->tree);
}

/* Finds them by Euclidean distance, for pieces that no edge joins to tracked skin. */
static void through_space(struct nearest *near, const struct rig *rig, const struct tracked *t, int i, int k)
{
	float d2[COUNT(near->d)];
	near->n = t->n < k + 1 ? t->n : k + 1;
	kdtree_find(t->tree, 1, rig->rest[i], near->n, near->vertex, d2);
	for (int j = 0; j < near->n; j++) {
		near->vertex[j] = t->vertex[near->vertex[j]];
		near->d[j] = sqrtf(d2[j]);
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

static void rows_make(struct row *rows, struct rig *rig, const struct labels *labels, const struct rig_conf *conf)
{
	struct tracked tracked = tracked_make(rig);
#pragma omp parallel for schedule(dynamic, 64)
	for (int i = 0; i < rig->n; i++) {
		struct nearest near;
		struct row *row = &rows[i];
		rig->fade[i] = 1;
		*row = (struct row){ 1, { i }, { 1 } };
		if (rig->source[i] != RIG_EXTRAPOLATED || rig_is_globe(rig->part[i]) || !tracked.n)
			continue;
		along_skin(&near, labels, i);
		if (!near.n || !(near.d[0] < (float)conf->fade[1]))
			through_space(&near, rig, &tracked, i, conf->neighbours);
		row->n = weigh(row->weight, &near, conf->neighbours);
		memcpy(row->column, near.vertex, (size_t)row->n * sizeof *row->column);
		rig->fade[i] = fade_at(near.d[0], conf->fade);
	}
	tracked_free(&tracked);
}

void rig_spread(struct rig *rig, const struct rig_conf *conf)
{
	struct graph g = graph_make(rig);
	struct labels labels = labels_make(rig, &g, conf->neighbours + 1, 2 * (float)conf->fade[1]);
	struct row *rows = mem_new((size_t)rig->n + 1, sizeof *rows);
	rows_make(rows, rig, &labels, conf);
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
	labels_free(&labels);
	graph_free(&g);
}
