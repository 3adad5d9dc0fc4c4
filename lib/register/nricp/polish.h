/* nricp_polish: the last step of a registration, along the normals. */
#ifndef REGISTER_NRICP_POLISH_H
#define REGISTER_NRICP_POLISH_H
#include "register/nricp/match.h"

/* Moves the points along their normals onto the fixed mesh, conf->polish_rounds times: matches them, then solves for an offset of
 * each that is smooth over `length` (screened Poisson equation on the graph's edges).
 * points  [graph->n], in and out: as the graph, with a node for every vertex, has placed them
 * match   [graph->n], in: the last matches' faces, where the search begins; out: those of the last round
 * length  in the unit of the points */
void nricp_polish(struct nricp_point *points, struct nricp_match *match, const struct nricp_graph *graph, const struct nricp_fixed *fixed,
                  const struct nricp_conf *conf, double length);

#endif
