/* deform: algorithm 1 of the skin paper (section 3.9): where every vertex of a rigged character goes, and its normal.
 * Single precision, one core, vector code; the bits do not depend on the instruction set.
 *
 * Beyond the paper: the skull map moves vertices, it does not place them (x = rest + T(u) - T(u at rest)), so that the
 * character keeps what the texture cannot hold: pores, folds, and where a lid overlaps itself. And delta0 fades with the
 * distance from the globe (rig.glue), so that a brow does not bob with the cornea. Vertices that neither keep a distance nor stand
 * where a globe reaches in this very pose are left where the skull map has them: what algorithm 1 would do, too.
 */
#ifndef RIG_DEFORM_DEFORM_H
#define RIG_DEFORM_DEFORM_H
#include "rig/rig.h"

struct deform;

/* Ready to evaluate; refers to rig, which must outlive it. */
struct deform *deform_new(const struct rig *rig);
void deform_free(struct deform *deform);

/* Everything at rest: [n][3] each. normal may be null, here and below. */
void deform_rest(const struct deform *deform, float (*xyz)[3], float (*normal)[3]);

/* The moving vertices, for components e and the globes' rotations (rig_globe_rotation; left, right); globe vertices turn
 * with theirs. Others are not written: deform_rest first. */
void deform_pose(const struct deform *deform, const double e[RIG_COMPONENTS], const double target_from_globe[2][3][3],
                 float (*xyz)[3], float (*normal)[3]);

#endif
