/* nricp_mirror: a character that is its own mirror image tells where the half goes that the subject lacks: where the mirror image
 * of the other half does, in the plane about which what was found is most nearly symmetric.
 */
#ifndef REGISTER_NRICP_MIRROR_H
#define REGISTER_NRICP_MIRROR_H
#include "register/nricp/match.h"

/* A plane: x with normal' x = at. */
struct nricp_plane {
	double normal[3], at;
};

/* Whether the mesh is its own mirror image about a plane square to one of its axes, through their origin or its own middle;
 * from_own: the mesh's frame from that of these axes. Vertices have to lie on vertices, to `tolerance`. */
bool nricp_plane_find(struct nricp_plane *out, const struct mesh *mesh, const double from_own[4][4], double tolerance);

/* For each node of a graph: the node nearest to its mirror image, and from there to the image itself. */
struct nricp_twins {
	struct nricp_plane plane;  // at rest
	int32_t *node;
	double (*off)[3];
};

void nricp_twins_make(struct nricp_twins *out, const struct nricp_graph *graph, const struct nricp_plane *plane);
void nricp_twins_free(struct nricp_twins *twins);

/* Nodes that nothing was found for, while it was for their twins, are asked (data) to stand where these do beyond the mirror,
 * with `weight` in place of a match's 1. affine: of the nodes, [n]. */
void nricp_twins_ask(struct nricp_pulls *data, const struct nricp_twins *twins, const struct nricp_graph *graph,
                     const struct nricp_point *points, const struct nricp_match *match, const double (*affine)[3][3], double weight);

#endif
