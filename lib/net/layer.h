/* layer: runs one layer of a network. */
#ifndef NET_LAYER_H
#define NET_LAYER_H
#include "net/graph.h"

/* out: of net_graph_size, set. first, second: what it reads (second null where that is nothing). work: net_conv_floats of a convolution. */
void net_layer_run(const struct net_planes *out, const struct net_layer *layer, const struct net_planes *first, const struct net_planes *second, float *work);

#endif
