/* deform: evaluates a rig: the position and normal of every vertex in a pose, algorithm 1 of the skin paper (section 3.9).
 * Single precision, one core, vector code; the bits do not depend on the instruction set.
 *
 * Differences from the paper: the skull map moves vertices instead of placing them (x = rest + T(u) - T(u at rest)), so that the
 * character keeps detail that the texture cannot hold: pores, folds, and where a lid overlaps itself. And delta0 fades with the
 * distance from the globe (rig.glue), so that a brow does not move with the cornea. Vertices that neither keep a distance nor lie
 * within a globe's reach in the pose stay where the skull map places them, as in algorithm 1; their globe distance is not computed.
 */
#ifndef RIG_DEFORM_DEFORM_H
#define RIG_DEFORM_DEFORM_H
#include "rig/rig.h"

struct deform;

/* Prepares a rig for evaluation; refers to it, so it must outlive the result. deform_free. */
struct deform *deform_new(const struct rig *rig);
void deform_free(struct deform *deform);

/* Writes all vertices at rest: xyz[n][3] in the character's axes, mm; normal[n][3], unit. normal may be null, here and below. */
void deform_rest(const struct deform *deform, float (*xyz)[3], float (*normal)[3]);

/* Writes the moving vertices in a pose; those that never move are not written: call deform_rest once before.
 * e                  components (rig_components)
 * target_from_globe  rotations of the globes, left and right (rig_globe_rotation); globe vertices turn with theirs
 * xyz, normal        as in deform_rest */
void deform_pose(const struct deform *deform, const double e[RIG_COMPONENTS], const double target_from_globe[2][3][3],
                 float (*xyz)[3], float (*normal)[3]);

#endif
