/* nricp_level: one level of a registration, its graph and everything of its nodes. */
#ifndef REGISTER_NRICP_LEVEL_H
#define REGISTER_NRICP_LEVEL_H
#include "register/nricp/mirror.h"

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
