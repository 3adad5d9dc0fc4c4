/* nricp: non-rigid iterative closest points: registers one mesh (the moving, a character) onto another (the fixed, the subject). Li,
 * Sumner, Pauly, "Global correspondence optimization for non-rigid registration of depth scans" (2008), with the deformation graph
 * refined until every vertex is a node.
 *
 * Lengths    both meshes are in the same unit; every length of the configuration is a share of the fixed mesh's size (mesh_size: the
 *            root mean square distance of its surface from its centroid, about a fifth of the diagonal's length).
 * Results do not depend on the number of threads.
 */
#ifndef REGISTER_NRICP_NRICP_H
#define REGISTER_NRICP_NRICP_H
#include "mesh/mesh.h"

enum { NRICP_LEVELS = 3 };

struct nricp_conf {
	int nodes[NRICP_LEVELS];   // of the graph on each level, coarse to fine; a mesh of fewer vertices is the last level itself
	int rounds[NRICP_LEVELS];  // of matching and solving on each
	double stiff[2];           // length over which the displacement bends, first and last round
	double noise;              // standard deviations of the fixed mesh's noise by which the last is longer
	double rigid;              // length above which the displacement rather bends than stretches
	double growth;             // share of a node's growth that counts as rigid
	double turn;               // length that counts as much as a normal turned by one radian
	double slide;              // weight of the distance along the surface over that across it
	double welsch[2];          // scale of the Welsch weight, first and last round
	double facing;             // least cosine between matched normals
	double rim;                // weight of boundary matched to boundary; 0: boundaries are free
	double rim_slide;          // weight of the distance along a boundary over that across it
	double rim_reach;          // scale of its Welsch weight
	double mirror;             // weight of the symmetry prior where nothing matches (nricp/mirror.h); 0: none
	int polish_rounds;         // rounds of the last step, along the normals (nricp/polish.h)
	double polish;             // length over which that is smooth
	double polish_noise;       // standard deviations of the fixed mesh's noise by which that is longer
};

/* Owned; nricp_result_free. */
struct nricp_result {
	float (*place)[3];        // [moving vertices] registered, in the fixed mesh's frame
	float *confidence;        // [moving vertices] weight of its match, 0..1
	int32_t *face;            // [moving vertices] face of the fixed mesh with the closest place of a like normal; -1: none
	float (*bary)[3];         // [moving vertices] weights of that face's corners
	double rms;               // root mean square distance of the matches, in the meshes' unit; INFINITY: nothing matched
	double covered;           // share of the moving mesh's area that matched
};

/* Registers the moving mesh onto the fixed one.
 * out                overwritten
 * fixed_from_moving  similarity that brings the moving mesh near first (nricp_align)
 * Returns false, err set, when a mesh has no surface. */
bool nricp_run(struct nricp_result *out, const struct mesh *moving, const struct mesh *fixed, const double fixed_from_moving[4][4],
               const struct nricp_conf *conf, struct err *err);
void nricp_result_free(struct nricp_result *result);

#endif
