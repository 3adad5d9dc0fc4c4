#include "register/nricp/sample.h"

#include <math.h>
#include <stdlib.h>

#include "base/mem.h"

struct entry {
	double distance;
	int32_t node;
};

struct heap {
	struct entry *items;
	int n, room;
};

static void push(struct heap *h, double distance, int32_t node)
{
	if (h->n == h->room)
		h->items = mem_grow(h->items, (size_t)(h->room = 2 * h->room + 256), sizeof *h->items);
	int i = h->n++;
	for (; i && h->items[(i - 1) / 2].distance > distance; i = (i - 1) / 2)
		h->items[i] = h->items[(i - 1) / 2];
	h->items[i] = (struct entry){ distance, node };
}

static struct entry pop(struct heap *h)
{
	struct entry top = h->items[0], last = h->items[--h->n];
	int i = 0;
	for (int child = 1; child < h->n; child = 2 * i + 1) {
		child += child + 1 < h->n && h->items[child + 1].distance < h->items[child].distance;
		if (h->items[child].distance >= last.distance)
			break;
		h->items[i] = h->items[child];
		i = child;
	}
	h->items[i] = last;
	return top;
}

static double apart(const double a[4], const double b[4])
{
	double x = a[0] - b[0], y = a[1] - b[1], z = a[2] - b[2];
	return sqrt(x * x + y * y + z * z);
}

/* Assigns to `owner` all nodes within reach of `seed` along the edges that are nearer to it than to earlier seeds (Dijkstra). */
static void claim(const struct nricp_graph *g, int32_t seed, int32_t owner, double reach, double *distance, int32_t *parent,
                  struct heap *heap)
{
	distance[seed] = 0;
	parent[seed] = owner;
	push(heap, 0, seed);
	while (heap->n) {
		struct entry e = pop(heap);
		if (e.distance > distance[e.node])
			continue;
		for (int32_t k = g->start[e.node]; k < g->start[e.node + 1]; k++) {
			int32_t v = g->neighbour[k];
			double d = e.distance + apart(g->place[e.node], g->place[v]);
			if (d < distance[v] && d <= reach) {
				distance[v] = d;
				parent[v] = owner;
				push(heap, d, v);
			}
		}
	}
}

int nricp_sample(int32_t *parent, int32_t *row, const struct nricp_graph *g, int nodes)
{
	double area = 0;
	for (int i = 0; i < g->n; i++)
		area += g->area[i];
	// Area a node over reach^2: sqrt(3) / 2 for the densest packing; distances along edges are longer: 0.75, measured on meshes.
	double reach = sqrt(area / (0.75 * nodes));
	double *distance = mem_array((size_t)g->n + 1, sizeof *distance);
	struct heap heap = { 0 };
	int n = 0;
	for (int i = 0; i < g->n; i++)
		distance[i] = INFINITY;
	for (int32_t i = 0; i < g->n; i++)
		if (distance[i] == INFINITY) {
			row[n] = i;
			claim(g, i, n++, reach, distance, parent, &heap);
		}
	free(heap.items);
	free(distance);
	return n;
}
