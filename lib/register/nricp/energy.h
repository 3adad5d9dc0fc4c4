/* nricp_energy: the deformation energy of a graph as a quadratic form in the nodes' displacements (nricp/graph.h). */
#ifndef REGISTER_NRICP_ENERGY_H
#define REGISTER_NRICP_ENERGY_H
#include "register/nricp/graph.h"

/* Computes spacing2, floor2, star, ridge and the matrix R (r_start, r_column, r_value) of a graph from its places, areas and edges.
 * rigidity  a length in the unit of the places: rho is the sum of a node's squared edges times their mean over rigidity^2 */
void nricp_graph_energy(struct nricp_graph *graph, double rigidity);

/* The right side that given rotations contribute: the energy is least where R t = out.
 * out   [n], overwritten; the fourth number is 0
 * turn  [n] R_i - I of each node, row-major (nricp_graph_turns) */
void nricp_graph_pull(double (*out)[4], const struct nricp_graph *graph, const double (*turn)[9]);

#endif
