/* surface: the eye's outside for compositors: depth and normal of every pixel. */
#ifndef DRAW_EYE_SURFACE_H
#define DRAW_EYE_SURFACE_H
#include "draw/eye/view.h"

/* Height of the iris' relief above its plane at the point (x, y) of it, mm; bilinear. */
double scene_relief_height(const struct scene *scene, double x, double y);

/* Returns [height][width][4]: depth of the nearest of cornea and sclera along the camera's axis (mm; INFINITY beside the eye), and
 * its unit normal in the camera's frame, without the film's ripples; image_free. */
struct image scene_surface(const struct scene *scene, const struct scene_view *view);

#endif
