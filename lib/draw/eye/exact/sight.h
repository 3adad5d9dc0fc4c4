/* sight: rays of sight through a pinhole. */
#ifndef DRAW_EYE_EXACT_SIGHT_H
#define DRAW_EYE_EXACT_SIGHT_H
#include "draw/eye/exact/trace.h"

/* Direction of the ray through a point (x, y) of the picture in the eye's frame, and where it meets a plane before the eye (mm):
 * [0] + x [1] + y [2]. */
struct sight_plane {
	float dir[3][3], from[3][3];
};
struct sight_plane sight_plane(const struct scene_look *look, const struct scene_view *view, double sphere_z);

/* A quick_make: unit rays through points of the picture (px), starting on that plane. */
void sight_rays_make(struct quick_rays *rays, const float *x, const float *y, const void *plane);

#endif
