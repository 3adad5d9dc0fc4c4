/* glb_bake: evaluates an animation and decomposes it into morph targets. */
#ifndef RIG_GLB_BAKE_H
#define RIG_GLB_BAKE_H
#include "rig/deform/deform.h"
#include "rig/glb/arkit.h"
#include "rig/glb/glb.h"

/* Whose weights a pose's follows: with w of pose `by`, v of pose `and`: w v, or 4 w (1 - w) v of a half; and < 0: v is 1. by < 0: nobody's. */
struct glb_driven {
	int by, and;
	bool half;
};

/* Owned; glb_bake_free. */
struct glb_bake {
	int n, *vertex;            // vertices that move, rows of the rig; skin alone
	int n_frames, n_targets;
	float *target, *lean;      // [n_targets][n][3] displacements of positions (mm) and of normals at weight 1
	int n_hair;                // vertices of conf->hairs (strands.h), then of the tears (tears.h); 0 without
	float *hair_target, *hair_pose;  // [n_targets][n_hair][3], [n_poses][n_hair][3] their displacements, mm
	float *weight;             // [n_frames][n_targets], within -1 .. 1
	int n_poses;               // GLB_POSES, then conf->expression, what blinks lack with those (mixed.h), GLB_TURNED, GLB_HALVES; 0 without
	char **pose_name;
	struct glb_driven *driven; // [n_poses]
	float *pose, *pose_lean;   // [n_poses][n][3] displacements of the named poses
	float *turn[2];            // [n_frames][4] quaternions x y z w of the eyeballs: from rest, in the rig's axes
	double worst;              // largest error of a vertex in a frame, mm
};

/* bake: overwritten; glb_bake_free in any case. Returns false, err set, when the decomposition does not converge. */
bool glb_bake_make(struct glb_bake *bake, const struct rig *rig, const struct drive *drive, const struct glb_conf *conf, struct err *err);
void glb_bake_free(struct glb_bake *bake);

#endif
