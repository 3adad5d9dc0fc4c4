/* nricp_align: brings one mesh onto another by rotation, translation and one scale, from any start, before they are
 * registered non-rigidly. No landmarks are needed; some are taken where they are known.
 */
#ifndef REGISTER_NRICP_ALIGN_H
#define REGISTER_NRICP_ALIGN_H
#include "mesh/mesh.h"

struct nricp_align_conf {
	int samples;         // points of the fixed mesh
	int rounds;          // of matching and solving, from a start
	double welsch[2];    // scale of the robust weight, first and last round; shares of the fixed mesh's size
	double turn;         // length that counts as much as a normal turned by one radian; share of the size
	double facing;       // least cosine between matched normals
	double scale_max;    // the scale stays within 1 / scale_max .. scale_max
	double good;         // share matched, with which no further start is tried
	double least;        // share matched, below which the meshes are said to have nothing in common
	int starts;          // places of the moving mesh tried when turning alone does not help
};

/* Rows of vertices that are the same place of a face. */
struct nricp_landmarks {
	int n;
	const int *moving, *fixed;  // [n]; null when n is 0
};

struct nricp_align_result {
	double fixed_from_moving[4][4];  // scale, rotation, translation
	double scale;
	double matched;       // 0..1: share of the fixed mesh that lies on the moving one after it
	double rms;           // of that share, in the fixed mesh's unit
	int start;            // which was best: 0 as they lie, 1 by centroids, ... ; -1 landmarks
};

/* Both meshes in the same unit, at least roughly (scale_max). False, err set, when no start brings them together. */
bool nricp_align(struct nricp_align_result *out, const struct mesh *moving, const struct mesh *fixed,
                 const struct nricp_landmarks *landmarks, const struct nricp_align_conf *conf, struct err *err);

#endif
