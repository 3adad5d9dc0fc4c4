/* nricp_impl: what the parts of nricp share. */
#ifndef SKIN_NRICP_IMPL_H
#define SKIN_NRICP_IMPL_H
#include "mesh/mesh.h"
#include "skin/nricp_graph.h"

/* Nodes about evenly spaced along the graph's edges: parent[n], row[returned]. */
int nricp_sample(int32_t *parent, int32_t *row, const struct nricp_graph *graph, int nodes);

/* star, ridge and R from places, areas and edges. */
void nricp_graph_energy(struct nricp_graph *graph, double rigidity);

/* Vertices (m x - center) scale: the caller's, free(); faces are the mesh's own, no colours. */
struct mesh nricp_carried(const struct mesh *mesh, const double m[4][4], const double center[3], double scale);

#endif
