/* nricp_mirror: a symmetry prior. Where the subject lacks one half of a face, a symmetric character's half without matches is pulled to
 * the mirror image of its matched half, about the plane that fits the matched parts of both best.
 */
#ifndef REGISTER_NRICP_MIRROR_H
#define REGISTER_NRICP_MIRROR_H
#include "register/nricp/match.h"

/* A plane: x with normal' x = at. */
struct nricp_plane {
	double normal[3], at;
};

/* Finds a plane of symmetry: perpendicular to one of the mesh's own axes, through their origin or through the middle of its extent; or
 * near the one across the x axis of the frame it stands in.
 * out        in the mesh's frame
 * from_own   the mesh's frame from that of its own axes
 * tolerance  distance within which a vertex must lie at the mirror image of another (for nine in ten of them), in the mesh's unit
 * Returns false when the mesh is not symmetric. */
bool nricp_plane_find(struct nricp_plane *out, const struct mesh *mesh, const double from_own[4][4], double tolerance);

/* For each node of a graph its twin: the node nearest to its mirror image at rest. nricp_twins_free. */
struct nricp_twins {
	struct nricp_plane plane;  // at rest
	int32_t *node;             // the twin
	double (*off)[3];          // from the twin to the mirror image itself
};

void nricp_twins_make(struct nricp_twins *out, const struct nricp_graph *graph, const struct nricp_plane *plane);
void nricp_twins_free(struct nricp_twins *twins);

/* Adds pulls (data) for nodes without a match whose twins have one: towards the mirror image of where the twin stands now, about the
 * plane that fits the nodes with two matched halves best. No effect when there is no such plane.
 * weight  of these pulls, against a match's 1
 * affine  [graph->n] the affine map A_i of each node */
void nricp_twins_ask(struct nricp_pulls *data, const struct nricp_twins *twins, const struct nricp_graph *graph,
                     const struct nricp_point *points, const struct nricp_match *match, const double (*affine)[3][3], double weight);

#endif
