#include "net/net.h"

#include <omp.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "net/file.h"
#include "net/graph.h"
#include "net/layer.h"
#include "net/room.h"

struct net {
	struct net_graph graph;
	int *last;              // of each result: the layer that reads it last
	pthread_mutex_t busy;   // of what follows
	struct net_room *rest;  // as many as pictures were ever worked on at once, those that are not in use
	int n_rest;
};

static struct net_room borrow(struct net *net)
{
	struct net_room room = { 0 };
	pthread_mutex_lock(&net->busy);
	if (net->n_rest > 0)
		room = net->rest[--net->n_rest];
	pthread_mutex_unlock(&net->busy);
	return room;
}

static void give_back(struct net *net, struct net_room room)
{
	pthread_mutex_lock(&net->busy);
	net->rest = mem_grow(net->rest, (size_t)net->n_rest + 1, sizeof *net->rest);
	net->rest[net->n_rest++] = room;
	pthread_mutex_unlock(&net->busy);
}

/* Sizes of all results; size[0] is the picture's. */
static bool sizes(struct net_size size[], const struct net_graph *g, struct err *err)
{
	for (int i = 0; i < g->n; i++) {
		const struct net_layer *l = &g->layer[i];
		if (!net_graph_size(&size[i + 1], l, size[l->in[0]], l->in[1] >= 0 ? size[l->in[1]] : (struct net_size){ 0 }, err))
			return false;
	}
	return true;
}

/* A result as it stands in a room. */
struct held { struct net_planes planes; int piece; };

static struct held hold(struct net_room *room, struct net_size size, int border)
{
	const int piece = net_room_take(room, net_planes_floats(size, border));
	return (struct held){ net_planes_in(room->piece[piece].floats, size, border), piece };
}

/* Runs layer i; what nothing reads any more is left. */
static void step(struct held held[], const struct net *net, int i, struct net_size size, struct net_room *room)
{
	const struct net_layer *l = &net->graph.layer[i];
	const struct net_planes *first = &held[l->in[0]].planes, *second = l->in[1] >= 0 ? &held[l->in[1]].planes : 0;
	const size_t work = l->kind == NET_CONV ? net_conv_floats(&l->conv, first->size, net->graph.border) : 0;
	held[i + 1] = hold(room, size, net->graph.border);
	const int piece = work ? net_room_take(room, work) : -1;
	net_layer_run(&held[i + 1].planes, l, first, second, work ? room->piece[piece].floats : 0);
	if (work)
		net_room_leave(room, piece);
	for (int k = 0; k <= i; k++)
		if (net->last[k] == i)
			net_room_leave(room, held[k].piece);
}

static void copy_in(const struct net_planes *to, const float *from)
{
	for (int c = 0; c < to->size.channels; c++)
		for (int y = 0; y < to->size.height; y++, from += to->size.width)
			memcpy(net_planes_row(to, c, y), from, (size_t)to->size.width * sizeof *from);
}

static float *copy_out(const struct net_planes *p)
{
	float *out = mem_array((size_t)p->size.channels * (size_t)p->size.height * (size_t)p->size.width, sizeof *out);
	for (int row = 0; row < p->size.channels * p->size.height; row++)
		memcpy(out + (long)row * p->size.width, net_planes_row(p, row / p->size.height, row % p->size.height), (size_t)p->size.width * sizeof *out);
	return out;
}

static bool run_one(struct net_picture *p, struct net *net, int channels, struct err *err)
{
	enum { PIXELS_MOST = 1 << 24 };
	const struct net_graph *g = &net->graph;
	struct net_size *size = mem_new((size_t)g->n + 1, sizeof *size);
	size[0] = (struct net_size){ channels, p->height, p->width };
	const bool fits = p->height > 0 && p->width > 0 && (long)p->height * p->width <= PIXELS_MOST;
	const bool ok = fits ? sizes(size, g, err) : err_set(err, "at most %d px", PIXELS_MOST);
	if (ok) {
		struct net_room room = borrow(net);
		struct held *held = mem_new((size_t)g->n + 1, sizeof *held);
		held[0] = hold(&room, size[0], g->border);
		copy_in(&held[0].planes, p->in);
		for (int i = 0; i < g->n; i++)
			step(held, net, i, size[i + 1], &room);
		p->out = copy_out(&held[g->n].planes);
		net_room_leave(&room, held[g->n].piece);
		memcpy(p->size, (const int[3]){ size[g->n].channels, size[g->n].height, size[g->n].width }, sizeof p->size);
		give_back(net, room);
		free(held);
	}
	free(size);
	return ok || err_wrap(err, "network: does not take %d x %d px of %d channels", p->width, p->height, channels);
}

/* A layer whose result nothing reads, but for the last, is read by itself. */
static int *last_uses(const struct net_graph *g)
{
	int *last = mem_new((size_t)g->n + 1, sizeof *last);
	for (int i = 0; i < g->n; i++) {
		const struct net_layer *l = &g->layer[i];
		last[i + 1] = i;
		last[l->in[0]] = i;
		if (l->in[1] >= 0)
			last[l->in[1]] = i;
	}
	last[g->n] = g->n;
	return last;
}

static bool makes(const struct net_graph *g, const int takes[3], const int gives[3], struct err *err)
{
	struct net_size *size = mem_new((size_t)g->n + 1, sizeof *size), got;
	size[0] = (struct net_size){ takes[0], takes[1], takes[2] };
	bool ok = sizes(size, g, err);
	got = size[g->n];
	free(size);
	if (ok && (got.channels != gives[0] || got.height != gives[1] || got.width != gives[2]))
		ok = err_set(err, "%d planes of %d x %d, must be %d of %d x %d", got.channels, got.width, got.height, gives[0], gives[2], gives[1]);
	return ok;
}

bool net_open(struct net **out, const char *path, const int takes[3], const int gives[3], struct err *err)
{
	char *data;
	size_t size;
	struct net_graph g;
	*out = 0;
	if (!net_file_read(&data, &size, path, err))
		return false;
	bool ok = net_graph_read(&g, data, size, err);
	free(data);
	ok = ok && makes(&g, takes, gives, err);
	if (!ok) {
		net_graph_free(&g);
		return err_wrap(err, "%s", path);
	}
	struct net *net = mem_new(1, sizeof *net);
	*net = (struct net){ .graph = g, .last = last_uses(&g), .busy = PTHREAD_MUTEX_INITIALIZER };
	*out = net;
	return true;
}

void net_close(struct net *net)
{
	if (!net)
		return;
	for (int i = 0; i < net->n_rest; i++)
		net_room_free(&net->rest[i]);
	free(net->rest);
	free(net->last);
	net_graph_free(&net->graph);
	free(net);
}

bool net_run(struct net_picture picture[], int n, struct net *net, int channels, struct err *err)
{
	struct err *errs = mem_new((size_t)n, sizeof *errs);
	int failed = n;
	for (int i = 0; i < n; i++)
		picture[i].out = 0;
#pragma omp parallel for schedule(dynamic, 1) num_threads(n < omp_get_max_threads() ? n : omp_get_max_threads()) reduction(min : failed)
	for (int i = 0; i < n; i++)
		if (!run_one(&picture[i], net, channels, &errs[i]))
			failed = i < failed ? i : failed;
	if (failed < n)
		*err = errs[failed];
	free(errs);
	for (int i = 0; i < n && failed < n; i++) {
		free(picture[i].out);
		picture[i].out = 0;
	}
	return failed == n;
}
