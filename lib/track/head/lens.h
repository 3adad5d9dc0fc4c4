/* lens: what the reference frame itself tells of the camera's focal length. A lens told too short puts the head too near, and what lies behind the lids (the
 * eyeballs' centres) would be drawn closer together, against them, than it is seen: perspective, which goes with 1 / distance and so with 1 / focal length.
 */
#ifndef TRACK_HEAD_LENS_H
#define TRACK_HEAD_LENS_H
#include "track/head/pose.h"

/* How much of the perspective that the lens told would make is seen: share 1 where it is right; the lens that fits best has its focal length over share.
 * sigma: one standard deviation of share, as far as the sights' weights are true; 0: nothing is known. */
struct head_lens {
	double share, sigma;
};

/* Maximum of the profile likelihood over the share: for each the pose is fitted anew (head_pose_fit), and sigma is from the cost's curvature there.
 * cam_from_head: the pose that those sights have under the lens told.
 * Returns false, lens zeroed, when they do not tell it: a head seen as flat, or a lens a tenth or ten times as long would fit best. */
bool head_lens_fit(struct head_lens *lens, const double cam_from_head[4][4], int n, const struct head_sight *sights, const struct camera *camera, double robust,
                   const struct head_prior *prior);

/* Mean distance of what is seen from the camera, mm, by weight; NAN without any: with another lens the head seems that much nearer or further. */
double head_lens_away(const double cam_from_head[4][4], int n, const struct head_sight *sights);

/* Both of two independent estimates. */
void head_lens_join(struct head_lens *lens, const struct head_lens *other);

#endif
