/* sfm_scene: a reconstruction made up for tests: cameras on an orbit round a ball of points, observations with noise. */
#ifndef TESTS_SFM_SCENE_H
#define TESTS_SFM_SCENE_H
#include <stdbool.h>

#include "sfm/colmap/colmap.h"

/* n_images views on a circle of radius 5 round the origin, n_points points in a ball of radius 1, each seen by all; noise of
 * sigma 0.3 px; errors of points as COLMAP stores them. SIMPLE_RADIAL, 1000 x 800 px. colmap_free. */
void sfm_scene(struct colmap_model *model, int n_images, int n_points, unsigned seed);

/* The unit quaternion w x y z, w >= 0, of a rotation: the inverse of colmap_rotation. */
void sfm_quaternion(double q[4], const double R[3][3]);

/* Two models say the same: names and numbers of things exactly, lengths and angles to within `slack` (pixels to a thousand
 * times that). */
bool sfm_same(const struct colmap_model *a, const struct colmap_model *b, double slack);

#endif
