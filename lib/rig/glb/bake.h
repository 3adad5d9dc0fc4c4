/* glb_bake: an evaluated animation, decomposed into morph targets. */
#ifndef RIG_GLB_BAKE_H
#define RIG_GLB_BAKE_H
#include "rig/deform/deform.h"
#include "rig/glb/glb.h"

enum { GLB_POSES = 12 };
extern const char *const glb_pose_names[GLB_POSES];

struct glb_bake {
	int n, *vertex;            // vertices that move, rows of the rig; skin alone
	int n_frames, n_targets;
	float *target, *lean;      // [n_targets][n][3] displacement of positions (mm) and normals at weight 1
	float *weight;             // [n_frames][n_targets], within -1 .. 1
	float *pose, *pose_lean;   // [GLB_POSES][n][3], or null
	float *turn[2];            // [n_frames][4] quaternions x y z w of the eyeballs: from rest, in the rig's axes
	double worst;              // mm
};

bool glb_bake_make(struct glb_bake *bake, const struct rig *rig, const struct drive *drive, const struct glb_conf *conf, struct err *err);
void glb_bake_free(struct glb_bake *bake);

#endif
