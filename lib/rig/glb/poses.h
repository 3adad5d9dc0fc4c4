/* poses: targets of single poses, by name: those of ARKit that gaze and lids give, and the expressions that the model has learnt. For the
 * files of this folder. */
#ifndef RIG_GLB_POSES_H
#define RIG_GLB_POSES_H
#include "rig/glb/bake.h"
#include "rig/glb/poser.h"

/* Fills n_poses, pose_name, pose, pose_lean and hair_pose of a bake. */
void glb_take_poses(struct glb_bake *bake, struct poser *poser, const struct glb_conf *conf);

#endif
