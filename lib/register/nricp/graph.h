/* nricp_graph: deformation graphs of a mesh, from coarse to fine, and the energy that keeps them smooth and rigid
 * (Li, Sumner, Pauly 2008, sections 3.1 and 3.2; Sumner, Schmid, Pauly 2007).
 *
 * A node carries an affine map A and a displacement t; the energies of the paper,
 *
 *     E_smooth = sum_ij |A_i e_ij + t_i - e_ij - t_j|^2,  E_rigid = sum_i rho |A_i - R_i|^2,   e_ij = g_j - g_i,
 *
 * are quadratic in A_i given the nearest rotation R_i: the best A_i is put in for A_i, which leaves a quadratic form in
 * the displacements alone, one matrix for x, y and z: 3 unknowns a node instead of 12.
 */
#ifndef REGISTER_NRICP_GRAPH_H
#define REGISTER_NRICP_GRAPH_H
#include <stdint.h>

/* Vectors of three are kept as four, the last 0: whole registers. */
struct nricp_graph {
	int n;
	double (*place)[4];         // at rest
	double *area;               // of the surface that each stands for
	double *spacing2;           // mean squared length of its edges; 0: it has none
	double floor2;              // shorter ones count as this
	int32_t *start, *neighbour; // neighbours[start[i]] .. [start[i + 1] - 1]
	int32_t *r_start, *r_column;  // R: displacements d cost d' R d for each of x, y, z; rows rise
	double *r_value;
	double *star;               // [edges][3]: (sum e e' + rho)^-1 e_ij: A_i - I = sum_j (t_j - t_i) star_ij' + ...
	double *ridge;              // [n][9]: ... + (R_i - I) ridge_i, rho (sum e e' + rho)^-1
	int32_t *parent;            // [n of the finer one] which node of this one it belongs to; null in the finest
	int32_t *row;               // [n] which node of the finer one it is; null in the finest
};

/* The finest graph: the places of n vertices, joined as start and neighbour say. Copies. rigidity: rho over the mean
 * squared edge. nricp_graph_free. */
void nricp_graph_make(struct nricp_graph *out, int n, const double (*place)[4], const double *area, const int32_t *start,
                      const int32_t *neighbour, double rigidity);

/* A coarser one of about `nodes` nodes, evenly spaced along the surface. Each piece keeps at least one. */
void nricp_graph_coarser(struct nricp_graph *out, const struct nricp_graph *finer, int nodes, double rigidity);
void nricp_graph_free(struct nricp_graph *graph);

/* A_i - I of node i: row-major [3][3]. turn: R_i - I, or null for 0. */
void nricp_graph_affine(double affine[3][3], const struct nricp_graph *graph, int i, const double (*t)[4], const double turn[9]);

/* R_i - I of every node, [n][9]: the rotation nearest to A_i at displacements t, grown by the share `growth` of how much
 * A_i grows (0: rigid as the paper's; 1: similarities cost nothing). */
void nricp_graph_turns(double (*turn)[9], const struct nricp_graph *graph, const double (*t)[4], double growth);

/* Displacements of the finer graph's nodes from the coarser one's: each node's affine map, blended between the node a
 * point belongs to and its neighbours by distance. */
void nricp_graph_spread(double (*fine_t)[4], const struct nricp_graph *fine, const struct nricp_graph *coarse, const double (*t)[4]);

#endif
