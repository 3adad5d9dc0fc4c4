/* nricp_level: one level of a registration: a deformation graph of the moving mesh, the places of its nodes and their matches. */
#ifndef REGISTER_NRICP_LEVEL_H
#define REGISTER_NRICP_LEVEL_H
#include "register/nricp/mirror.h"

/* Arrays are by node and owned; nricp_level_free. */
struct nricp_level {
	struct nricp_graph graph;
	double (*t)[4];                 // displacements
	double (*turn)[9], (*pull)[4], (*affine)[3][3];  // of nricp_graph_turns and nricp_graph_pull; A_i
	float (*normal)[3], (*out)[3];  // at rest; out: off the surface, at its boundary (nricp_outward)
	uint8_t *boundary;
	struct nricp_point *points;
	struct nricp_match *match;
	struct nricp_pulls data;
	struct nricp_twins twins;        // of the symmetry prior; empty: not needed so far
};

/* Make a level with a node for every vertex, or with about `nodes` of the finer level's nodes. rigid: of nricp_graph_make. */
void nricp_level_finest(struct nricp_level *out, const struct mesh *moving, double rigid);
void nricp_level_coarser(struct nricp_level *out, const struct nricp_level *fine, int nodes, double rigid);
void nricp_level_free(struct nricp_level *level);

/* Computes affine and points (place, normal, direction off the surface) from the displacements t. */
void nricp_level_stand(struct nricp_level *level);

/* Computes data, the quadratic data term, from the matches. */
void nricp_level_ask(struct nricp_level *level, const struct nricp_conf *conf);

#endif
