/* graph: a network as its layers, read from ONNX (onnx.ai, operator set 11; onnx.proto for the numbers of the fields).
 *
 * Taken are: Conv (one stride, one padding on all sides, no dilation), with Relu or Tanh behind it; Mul and Sub by a number; Resize to twice the size by
 * repeating pixels, where it goes into an Add; Add; AveragePool without padding or overlap; Concat of rows; Pad by nothing. That is what tests/evidence trains.
 */
#ifndef NET_GRAPH_H
#define NET_GRAPH_H
#include "base/err.h"
#include "net/conv.h"

enum net_kind { NET_CONV, NET_SCALE, NET_ADD, NET_MEAN, NET_STACK };

/* Results are counted from the network's input, 0; that of layer i is i + 1. */
struct net_layer {
	enum net_kind kind;
	int in[2];             // what it reads; in[1] of NET_ADD and NET_STACK alone, else -1
	bool doubled;          // NET_ADD: each pixel of in[0] counts for two by two
	float gain, offset;    // NET_SCALE: gain x + offset
	int height, width;     // NET_MEAN: of the windows, side by side, of which it takes the means
	struct net_conv conv;  // NET_CONV
};

struct net_graph {
	struct net_layer *layer;
	int n;
	int border;            // the largest padding of its convolutions
};

/* The graph of ONNX's bytes, which may go then; its last layer gives the network's result. net_graph_free. False, err set (one line without a place), g empty:
 * it is damaged, or holds what is not taken. */
bool net_graph_read(struct net_graph *g, const void *data, size_t size, struct err *err);
void net_graph_free(struct net_graph *g);

/* Size of a layer's result, from those of what it reads. False, err set: it does not take them. */
bool net_graph_size(struct net_size *out, const struct net_layer *layer, struct net_size first, struct net_size second, struct err *err);

#endif
