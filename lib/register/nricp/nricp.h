/* nricp: non-rigid registration of one mesh (the moving, a character) onto another (the fixed, the subject): Li, Sumner,
 * Pauly, "Global correspondence optimization for non-rigid registration of depth scans" (2008), with the deformation
 * graph refined until every vertex is a node.
 *
 * Lengths    of both meshes in the same unit; every length of the configuration is a share of the fixed mesh's size (the
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
	double noise;              // the last is longer by so many standard deviations of the fixed mesh's noise
	double rigid;              // length above which it rather bends than stretches
	double growth;             // share of a node's growth that counts as rigid
	double turn;               // length that counts as much as a normal turned by one radian
	double slide;              // weight of the distance along the surface over that across it
	double welsch[2];          // scale of the robust weight, first and last round
	double facing;             // least cosine between matched normals
	double rim;                // weight of boundary matched to boundary; 0: boundaries are free
	double rim_slide;          // weight of the distance along a boundary over that across it
	double rim_reach;          // scale of its robust weight
	double mirror;             // weight of the mirror image of the other half where nothing matches; 0: it is not asked
	int polish_rounds;         // last steps, of all vertices along their normals
	double polish;             // length over which these are smooth
	double polish_noise;       // longer by so many standard deviations of the fixed mesh's noise
};

struct nricp_result {
	float (*place)[3];        // [moving vertices] registered; owned
	float *confidence;        // [moving vertices] 0..1; owned
	int32_t *face;            // [moving vertices] of the fixed mesh, on which the closest place of a like normal lies; -1: none; owned
	float (*bary)[3];         // [moving vertices] weights of its corners there; owned
	double rms, covered;      // of what matched: distance; share of the moving area that matched
};

/* fixed_from_moving brings the moving mesh near first (nricp_align). False, err set, when there is nothing to register. */
bool nricp_run(struct nricp_result *out, const struct mesh *moving, const struct mesh *fixed, const double fixed_from_moving[4][4],
               const struct nricp_conf *conf, struct err *err);
void nricp_result_free(struct nricp_result *result);

#endif
