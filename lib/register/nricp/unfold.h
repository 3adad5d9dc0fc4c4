/* nricp_unfold: rights triangles that a registration has turned over. */
#ifndef REGISTER_NRICP_UNFOLD_H
#define REGISTER_NRICP_UNFOLD_H
#include "register/nricp/match.h"

/* Smooths displacements around triangles whose normal has turned over, over as many rings of vertices as that needs.
 * points  [graph->n], in and out: a point for every vertex of rest
 * rest    the moving mesh before the registration, in the points' frame
 * Returns how many triangles are still folded. */
int nricp_unfold(struct nricp_point *points, const struct mesh *rest, const struct nricp_graph *graph);

#endif
