/* shade_lens: what a face's shading tells of the camera's focal length: the nose is nearer than the temples, and seen as much larger as the camera is near.
 */
#ifndef TRACK_HEAD_SHADE_LENS_H
#define TRACK_HEAD_SHADE_LENS_H
#include "track/head/lens.h"
#include "track/head/shade.h"

/* How much of the perspective that the lens told would make the shading shows. Under each of a range of lenses the head is laid on by the sights and its shading
 * (head_pose_fit, head_shade); a parabola through what the shading costs there has its bottom at the share. Arguments as those of head_lens_fit and
 * head_shade. Returns false, lens unchanged, where it tells nothing. */
bool head_shade_lens(struct head_lens *lens, const struct head_shape *shape, const struct head_picture *picture, const struct camera *camera,
                     const double cam_from_head[4][4], int n, const struct head_sight *sights, double robust, const struct head_prior *prior,
                     const struct head_shade_conf *conf);

#endif
