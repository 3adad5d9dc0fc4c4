/* nricp_graph: deformation graphs of a mesh, from coarse to fine, and the energy that keeps them smooth and rigid
 * (Li, Sumner, Pauly 2008, sections 3.1 and 3.2; Sumner, Schmid, Pauly 2007).
 *
 * A node carries an affine map A and a displacement t; the energies of the paper,
 *
 *     E_smooth = sum_ij |A_i e_ij + t_i - e_ij - t_j|^2,  E_rigid = sum_i rho |A_i - R_i|^2,   e_ij = g_j - g_i,
 *
 * are quadratic in A_i given its nearest rotation R_i. Minimising over A_i in closed form leaves a quadratic form in the
 * displacements alone, with one matrix for x, y and z: 3 unknowns a node instead of 12.
 */
#ifndef REGISTER_NRICP_GRAPH_H
#define REGISTER_NRICP_GRAPH_H
#include <stdint.h>

/* Owned. Vectors of three are stored as four numbers, the last 0, to fill registers. */
struct nricp_graph {
	int n;
	double (*place)[4];         // at rest
	double *area;               // of the surface that each node represents
	double *spacing2;           // mean squared length of its edges; 0: it has none
	double floor2;              // least value that spacing2 counts as
	int32_t *start, *neighbour; // edges: neighbour[start[i]] .. [start[i + 1] - 1] of node i
	int32_t *r_start, *r_column;  // R, compressed rows, the diagonal first: displacements d cost d' R d for each of x, y, z
	double *r_value;
	double *star;               // [edges][3]: (sum e e' + rho)^-1 e_ij: A_i - I = sum_j (t_j - t_i) star_ij' + ...
	double *ridge;              // [n][9]: ... + (R_i - I) ridge_i, rho (sum e e' + rho)^-1
	int32_t *parent;            // [n of the finer graph] the node of this graph that it belongs to; null in the finest
	int32_t *row;               // [n] the node's index in the finer graph; null in the finest
};

/* Makes the finest graph from n vertices; everything is copied. nricp_graph_free.
 * place, area       of the vertices; start, neighbour: the edges, both directions of each
 * rigidity          length above which a node rather bends than stretches (rho, nricp/energy.h); the unit of place */
void nricp_graph_make(struct nricp_graph *out, int n, const double (*place)[4], const double *area, const int32_t *start,
                      const int32_t *neighbour, double rigidity);

/* Makes a coarser graph of about `nodes` nodes, evenly spaced along the surface, at least one on each connected piece. */
void nricp_graph_coarser(struct nricp_graph *out, const struct nricp_graph *finer, int nodes, double rigidity);
void nricp_graph_free(struct nricp_graph *graph);

/* The best affine map of node i at displacements t: A_i - I. turn: R_i - I, row-major, or null for 0. */
void nricp_graph_affine(double affine[3][3], const struct nricp_graph *graph, int i, const double (*t)[4], const double turn[9]);

/* Updates R_i - I of every node, turn[n][9], in and out: the rotation nearest to A_i at displacements t, scaled by the share `growth`
 * of A_i's own scale (0: rigid, as in the paper; 1: similarities cost nothing). */
void nricp_graph_turns(double (*turn)[9], const struct nricp_graph *graph, const double (*t)[4], double growth);

/* Displacements fine_t of the finer graph's nodes from those of the coarser one, t: the affine maps of the parent and its neighbours,
 * blended by distance. The fourth number is 0. */
void nricp_graph_spread(double (*fine_t)[4], const struct nricp_graph *fine, const struct nricp_graph *coarse, const double (*t)[4]);

#endif
