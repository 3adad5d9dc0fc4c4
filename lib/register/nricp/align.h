/* nricp_align: rigid registration with scale: brings one mesh onto another by a similarity, from any start, before they are
 * registered non-rigidly (iterative closest points with Welsch weights). Landmarks are optional.
 * Lengths of the configuration are shares of the fixed mesh's size (mesh_size).
 */
#ifndef REGISTER_NRICP_ALIGN_H
#define REGISTER_NRICP_ALIGN_H
#include "mesh/mesh.h"

struct nricp_align_conf {
	int samples;         // points of the fixed mesh
	int rounds;          // of matching and solving, from a start
	double welsch[2];    // scale of the Welsch weight, first and last round; share of the size
	double turn;         // length that counts as much as a normal turned by one radian; share of the size
	double facing;       // least cosine between matched normals
	double scale_max;    // the scale stays within 1 / scale_max .. scale_max
	double good;         // share matched at which no further start is tried
	double least;        // share matched below which the alignment fails
	int starts;          // places of the moving mesh tried when turning alone does not help
};

/* Pairs of vertices that are the same place of a face. */
struct nricp_landmarks {
	int n;
	const int *moving, *fixed;  // [n] rows of either mesh; null when n is 0
};

struct nricp_align_result {
	double fixed_from_moving[4][4];  // scale, rotation, translation
	double scale;
	double matched;       // 0..1: share of the fixed mesh that lies on the moving one after it
	double rms;           // of that share, in the fixed mesh's unit
	int start;            // the best start: -1 landmarks, 0 as they lie, 1 by centroids, 2..24 turned, 26 a place of the moving mesh
};

/* Aligns the meshes, from the landmarks where there are three or more, else from several starts until one is good.
 * out        overwritten, on failure with the best that was found
 * moving, fixed  in the same unit, to within a factor of conf->scale_max
 * landmarks  may be null
 * Returns false, err set, when less than conf->least of the fixed mesh was matched. */
bool nricp_align(struct nricp_align_result *out, const struct mesh *moving, const struct mesh *fixed,
                 const struct nricp_landmarks *landmarks, const struct nricp_align_conf *conf, struct err *err);

#endif
