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
	double fine;         // scale of the Welsch weight by which poses are compared; share of the size
	double margin;       // what any other pose leaves unmatched by the fine scale is at least so many times what the best leaves
	double good;         // fine share of the best below which places all over the moving mesh are tried, too; and without the margin
	double least;        // share matched below which the alignment fails
	int starts;          // number of these places
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
	double fine;          // 0..1: the same share by the fine scale; less with a scale far from 1, but for landmarks
	double rival;         // fine share of the best pose that differs from it; 0 with landmarks, where no other is tried
	bool bound;           // the scale ended at its bound: no similarity within the bounds fits
};

/* Whether a pose of that fine share stands out against another's. */
static inline bool nricp_stands_out(double fine, double other, double margin)
{
	return 1 - other >= margin * (1 - fine);
}

/* Aligns the meshes, from the landmarks where there are three or more, else from 24 rotations, and places of the moving mesh where
 * these do not help. All are compared by the fine share: a head upside down reaches half of the true pose's.
 * out        overwritten, on failure with the best that was found
 * moving, fixed  in the same unit, to within a factor of conf->scale_max; moving may be turned in any way
 * landmarks  may be null
 * Returns false, err set, when less than conf->least of the fixed mesh was matched, when another pose fits nearly as well
 * (conf->margin), or when the scale ended at its bound. */
bool nricp_align(struct nricp_align_result *out, const struct mesh *moving, const struct mesh *fixed,
                 const struct nricp_landmarks *landmarks, const struct nricp_align_conf *conf, struct err *err);

#endif
