/* nricp_impl: what the parts of nricp share. */
#ifndef REGISTER_NRICP_IMPL_H
#define REGISTER_NRICP_IMPL_H
#include "register/nricp/match.h"
#include "register/nricp/mirror.h"

/* Nodes about evenly spaced along the graph's edges: parent[n], row[returned]. */
int nricp_sample(int32_t *parent, int32_t *row, const struct nricp_graph *graph, int nodes);

/* star, ridge and R from places, areas and edges. */
void nricp_graph_energy(struct nricp_graph *graph, double rigidity);

/* Vertices (m x - center) scale: the caller's, free(); faces are the mesh's own, no colours. */
struct mesh nricp_carried(const struct mesh *mesh, const double m[4][4], const double center[3], double scale);

/* A graph of the moving mesh, where its nodes stand, and what they are asked to do. */
struct nricp_level {
	struct nricp_graph graph;
	double (*t)[4], (*turn)[9], (*pull)[4], (*affine)[3][3];
	float (*normal)[3], (*out)[3];  // at rest
	uint8_t *boundary;
	struct nricp_point *points;
	struct nricp_match *match;
	struct nricp_pulls data;
	struct nricp_twins twins;        // empty: not asked for
};

/* A node for every vertex; or about `nodes` of the finer one's. rigid: of nricp_graph_make. nricp_level_free. */
void nricp_level_finest(struct nricp_level *out, const struct mesh *moving, double rigid);
void nricp_level_coarser(struct nricp_level *out, const struct nricp_level *fine, int nodes, double rigid);
void nricp_level_free(struct nricp_level *level);

/* affine and points: where the nodes stand after t, and which way they face. */
void nricp_level_stand(struct nricp_level *level);

/* data: what the matches ask for. */
void nricp_level_ask(struct nricp_level *level, const struct nricp_conf *conf);

#endif
