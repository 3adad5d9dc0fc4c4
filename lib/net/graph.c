#include "net/graph.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "net/onnx.h"

enum { CHANNELS_MOST = 4096, KERNEL_MOST = 15, STRIDE_MOST = 8, WINDOW_MOST = 4096, ALONE = -1, GONE = -2 };
_Static_assert(KERNEL_MOST * KERNEL_MOST <= NET_CONV_TAPS, "each tap has its place");

/* What a name stands for: the result of a layer, with each pixel counting for two by two or not. */
struct named { struct proto name; int result; bool doubled; };

struct reader {
	struct net_graph *g;
	struct onnx_tensor *tensor;
	struct named *named;
	int n_tensors, n_named;
};

static struct named *find(const struct reader *r, struct proto name)
{
	for (int i = r->n_named - 1; i >= 0; i--)
		if (proto_same(r->named[i].name, name))
			return &r->named[i];
	return 0;
}

static const struct onnx_tensor *tensor_of(const struct reader *r, const struct onnx_node *node, int i, int type)
{
	for (int k = 0; k < r->n_tensors && i < node->n_in; k++)
		if (proto_same(r->tensor[k].name, node->in[i]) && r->tensor[k].type == type)
			return &r->tensor[k];
	return 0;
}

/* The result that input i of a node is; GONE where it is none, or one that went into what came behind it. */
static int input(const struct reader *r, const struct onnx_node *node, int i)
{
	const struct named *n = i < node->n_in ? find(r, node->in[i]) : 0;
	return n && !n->doubled ? n->result : GONE;
}

static bool name(struct reader *r, struct proto text, int result, bool doubled)
{
	r->named = mem_grow(r->named, (size_t)r->n_named + 1, sizeof *r->named);
	r->named[r->n_named++] = (struct named){ text, result, doubled };
	return true;
}

/* Adds a layer, whose result bears the node's name. False where it reads what is no result. */
static bool add(struct reader *r, const struct onnx_node *node, struct net_layer layer)
{
	struct net_graph *g = r->g;
	if (layer.in[0] < 0 || layer.in[1] == GONE)
		return false;
	g->layer = mem_grow(g->layer, (size_t)g->n + 1, sizeof *g->layer);
	g->layer[g->n++] = layer;
	return name(r, node->out, g->n, false);
}

static bool constant(struct reader *r, const struct onnx_node *node)
{
	const struct onnx_attribute *value = onnx_attribute(node, "value");
	r->tensor = mem_grow(r->tensor, (size_t)r->n_tensors + 1, sizeof *r->tensor);
	struct onnx_tensor *t = &r->tensor[r->n_tensors];
	if (!value || !onnx_tensor_read(t, value->tensor))
		return false;
	t->name = node->out;
	r->n_tensors++;
	return true;
}

static bool convolution(struct reader *r, const struct onnx_node *node)
{
	const struct onnx_tensor *weight = tensor_of(r, node, 1, ONNX_FLOAT), *bias = tensor_of(r, node, 2, ONNX_FLOAT);
	int dilation[2], stride[2], pad[4], groups;
	if (!weight || !bias || weight->n_dims != 4 || bias->count != weight->dim[0] || !onnx_numbers(&groups, 1, node, "group", 1, 1, CHANNELS_MOST)
	    || !onnx_numbers(dilation, 2, node, "dilations", 1, 1, 1) || !onnx_numbers(stride, 2, node, "strides", 1, 1, STRIDE_MOST)
	    || !onnx_numbers(pad, 4, node, "pads", 0, 0, KERNEL_MOST - 1))
		return false;
	const long out = weight->dim[0], in = weight->dim[1], high = weight->dim[2], wide = weight->dim[3];
	const bool even = stride[0] == stride[1] && pad[0] == pad[1] && pad[0] == pad[2] && pad[0] == pad[3];
	if (!even || out < 1 || out > CHANNELS_MOST || out % groups || in < 1 || in * groups > CHANNELS_MOST || high < 1 || high > KERNEL_MOST || wide < 1
	    || wide > KERNEL_MOST || onnx_attribute(node, "auto_pad"))
		return false;
	struct net_layer layer = { .kind = NET_CONV, .in = { input(r, node, 0), ALONE },
		                   .conv = { (int)in * groups, (int)out, groups, (int)high, (int)wide, stride[0], pad[0], NET_PLAIN, 0, 0 } };
	if (!add(r, node, layer))
		return false;
	net_conv_make(&r->g->layer[r->g->n - 1].conv, weight->raw.at, bias->raw.at);
	r->g->border = pad[0] > r->g->border ? pad[0] : r->g->border;
	return true;
}

/* Goes into the convolution before it, whose own result nothing else may read. */
static bool activation(struct reader *r, const struct onnx_node *node, enum net_act act)
{
	struct named *before = node->n_in == 1 ? find(r, node->in[0]) : 0;
	struct net_graph *g = r->g;
	if (!before || before->doubled || before->result < 1 || before->result != g->n || g->layer[g->n - 1].kind != NET_CONV || g->layer[g->n - 1].conv.act != NET_PLAIN)
		return false;
	g->layer[g->n - 1].conv.act = act;
	before->result = GONE;
	return name(r, node->out, g->n, false);
}

static bool relu(struct reader *r, const struct onnx_node *node)
{
	return activation(r, node, NET_RELU);
}

static bool hyperbolic(struct reader *r, const struct onnx_node *node)
{
	return activation(r, node, NET_TANH);
}

static bool scale(struct reader *r, const struct onnx_node *node)
{
	const struct onnx_tensor *by = tensor_of(r, node, 1, ONNX_FLOAT);
	float value;
	if (!by || by->count != 1)
		return false;
	memcpy(&value, by->raw.at, sizeof value);
	const bool times = proto_is(node->kind, "Mul");
	return add(r, node, (struct net_layer){ .kind = NET_SCALE, .in = { input(r, node, 0), ALONE }, .gain = times ? value : 1, .offset = times ? 0 : -value });
}

static bool sum(struct reader *r, const struct onnx_node *node)
{
	const struct named *first = node->n_in == 2 ? find(r, node->in[0]) : 0;
	return first && add(r, node, (struct net_layer){ .kind = NET_ADD, .in = { first->result, input(r, node, 1) }, .doubled = first->doubled });
}

static bool resize(struct reader *r, const struct onnx_node *node)
{
	const struct onnx_tensor *by = tensor_of(r, node, 2, ONNX_FLOAT);
	const struct onnx_attribute *mode = onnx_attribute(node, "mode"), *from = onnx_attribute(node, "coordinate_transformation_mode"),
	                            *nearest = onnx_attribute(node, "nearest_mode");
	float factor[4];
	const int of = input(r, node, 0);
	if (of == GONE || node->n_in != 3 || !by || by->count != 4 || !mode || !proto_is(mode->text, "nearest") || !from || !proto_is(from->text, "asymmetric") || !nearest
	    || !proto_is(nearest->text, "floor"))
		return false;
	memcpy(factor, by->raw.at, sizeof factor);
	return factor[0] == 1 && factor[1] == 1 && factor[2] == 2 && factor[3] == 2 && name(r, node->out, of, true);
}

static bool pad(struct reader *r, const struct onnx_node *node)
{
	const struct onnx_tensor *by = tensor_of(r, node, 1, ONNX_INT64);
	const int of = input(r, node, 0);
	if (!by || of == GONE)
		return false;
	for (const uint8_t *at = by->raw.at; at < by->raw.end; at++)
		if (*at)
			return false;
	return name(r, node->out, of, false);
}

static bool mean(struct reader *r, const struct onnx_node *node)
{
	int window[2], stride[2], by[4], up;
	if (!onnx_attribute(node, "kernel_shape") || !onnx_numbers(window, 2, node, "kernel_shape", 1, 1, WINDOW_MOST)
	    || !onnx_numbers(stride, 2, node, "strides", 1, 1, WINDOW_MOST) || !onnx_numbers(by, 4, node, "pads", 0, 0, 0)
	    || !onnx_numbers(&up, 1, node, "ceil_mode", 0, 0, 0) || stride[0] != window[0] || stride[1] != window[1] || onnx_attribute(node, "auto_pad"))
		return false;
	return add(r, node, (struct net_layer){ .kind = NET_MEAN, .in = { input(r, node, 0), ALONE }, .height = window[0], .width = window[1] });
}

static bool stack(struct reader *r, const struct onnx_node *node)
{
	enum { ROWS = 2 };
	int axis;
	if (node->n_in != 2 || !onnx_numbers(&axis, 1, node, "axis", 0, ROWS, ROWS) || axis != ROWS)
		return false;
	return add(r, node, (struct net_layer){ .kind = NET_STACK, .in = { input(r, node, 0), input(r, node, 1) } });
}

static bool operation(struct reader *r, struct proto message, struct err *err)
{
	static const struct { const char *kind; bool (*read)(struct reader *, const struct onnx_node *); } kinds[] = {
		{ "Constant", constant }, { "Conv", convolution }, { "Relu", relu }, { "Tanh", hyperbolic }, { "Mul", scale }, { "Sub", scale }, { "Add", sum },
		{ "Resize", resize }, { "Pad", pad }, { "AveragePool", mean }, { "Concat", stack },
	};
	struct onnx_node node;
	if (!onnx_node_read(&node, message))
		return err_set(err, "damaged after %d layers", r->g->n);
	for (int i = 0; i < COUNT(kinds); i++)
		if (proto_is(node.kind, kinds[i].kind))
			return kinds[i].read(r, &node) || err_set(err, "operation %s after %d layers is not of a kind that is run here", kinds[i].kind, r->g->n);
	return err_set(err, "an operation after %d layers is of a kind that is not run here", r->g->n);
}

/* Tensors and input first: operations may stand before them. */
static bool read_graph(struct reader *r, struct proto graph, struct err *err)
{
	enum { NODE = 1, TENSOR = 5, IN = 11, OUT = 12, NAME = 1 };
	struct proto at = graph, of;
	struct proto_field f, g;
	const struct named *out = 0;
	while (proto_next(&f, &at)) {
		if (f.number == TENSOR) {
			r->tensor = mem_grow(r->tensor, (size_t)r->n_tensors + 1, sizeof *r->tensor);
			if (!onnx_tensor_read(&r->tensor[r->n_tensors++], f.bytes))
				return err_set(err, "weights %d are damaged", r->n_tensors);
		}
		for (of = f.bytes; f.number == IN && r->n_named == 0 && proto_next(&g, &of);)
			if (g.number == NAME)
				name(r, g.bytes, 0, false);
	}
	if (!at.at || r->n_named != 1)
		return err_set(err, "damaged, or without an input");
	for (at = graph; proto_next(&f, &at);)
		if (f.number == NODE && !operation(r, f.bytes, err))
			return false;
	for (at = graph; proto_next(&f, &at);)
		for (of = f.bytes; f.number == OUT && proto_next(&g, &of);)
			if (g.number == NAME)
				out = find(r, g.bytes);
	return (r->g->n > 0 && out && out->result == r->g->n && !out->doubled) || err_set(err, "its result is not that of its last layer");
}

bool net_graph_read(struct net_graph *g, const void *data, size_t size, struct err *err)
{
	enum { GRAPH = 7 };
	struct reader r = { .g = g };
	struct proto model = { data, (const uint8_t *)data + size };
	struct proto_field f;
	bool ok = false;
	*g = (struct net_graph){ 0 };
	while (!ok && proto_next(&f, &model))
		if (f.number == GRAPH) {
			ok = read_graph(&r, f.bytes, err);
			break;
		}
	free(r.tensor);
	free(r.named);
	if (ok)
		return true;
	net_graph_free(g);
	return err_set(err, "damaged, or without a graph");
}

void net_graph_free(struct net_graph *g)
{
	for (int i = 0; i < g->n; i++)
		net_conv_free(&g->layer[i].conv);
	free(g->layer);
	*g = (struct net_graph){ 0 };
}

bool net_graph_size(struct net_size *out, const struct net_layer *l, struct net_size a, struct net_size b, struct err *err)
{
	const int by = l->doubled ? 2 : 1;
	bool ok = true;
	*out = a;
	switch (l->kind) {
	case NET_CONV:
		ok = a.channels == l->conv.in;
		*out = net_conv_size(&l->conv, a);
		break;
	case NET_SCALE: break;
	case NET_ADD:
		ok = a.channels == b.channels && by * a.height == b.height && by * a.width == b.width;
		*out = b;
		break;
	case NET_MEAN:
		out->height /= l->height;
		out->width /= l->width;
		break;
	case NET_STACK:
		ok = a.channels == b.channels && a.width == b.width;
		out->height += b.height;
		break;
	}
	return (ok && out->height > 0 && out->width > 0)
	       || err_set(err, "%d planes of %d x %d%s do not fit a layer", a.channels, a.width, a.height, l->in[1] >= 0 ? " beside others" : "");
}
