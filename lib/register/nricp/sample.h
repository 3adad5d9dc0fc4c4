/* nricp_sample: picks evenly spaced nodes of a deformation graph. */
#ifndef REGISTER_NRICP_SAMPLE_H
#define REGISTER_NRICP_SAMPLE_H
#include "register/nricp/graph.h"

/* Picks about `nodes` nodes, evenly spaced along the graph's edges, at least one on each connected piece.
 * parent  [graph->n], out: index into row of the picked node that each node belongs to
 * row     [graph->n], out: the first `returned` are the nodes picked
 * Returns how many were picked. */
int nricp_sample(int32_t *parent, int32_t *row, const struct nricp_graph *graph, int nodes);

#endif
