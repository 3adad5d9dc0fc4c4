/* head_pose: where the head is, from points of its mesh and where they are seen.
 * Head frame  the subject mesh's axes, mm.  Camera  x right, y down, z forward, mm.  Image  px, first centre (0.5, 0.5).
 */
#ifndef TRACK_HEAD_POSE_H
#define TRACK_HEAD_POSE_H
#include <stdbool.h>

#include "optics/camera.h"

/* What the pose is expected to be, and how well it is known: rotations about the camera's x, y, z (radians) and
 * translations (mm) away from it; INFINITY: not at all. */
struct head_prior {
	double cam_from_head[4][4];
	double sigma[6];
};

/* One measurement: a point is seen at px (line false), or on a line through px with a unit normal (line true). */
struct head_sight {
	double head[3], px[2], normal[2];
	bool line;
	bool sure;             // no outlier, however far off
	double weight;         // 1 / sigma^2, px^-2; 0: left out
};

/* Improves cam_from_head by Gauss-Newton with Geman and McClure's weights of scale `robust` px (INFINITY: least squares).
 * prior may be null. Returns the weighted rms of the residuals, px; NAN, cam_from_head untouched, where the points do not
 * determine a pose. camera->focal_px must be known. */
double head_pose_fit(double cam_from_head[4][4], int n, const struct head_sight *sights, const struct camera *camera,
                     double robust, const struct head_prior *prior);

void head_from(double out[3], const double cam_from_head[4][4], const double head[3]);

/* The inverse motion. */
void head_to(double out[3], const double cam_from_head[4][4], const double cam[3]);

/* Pixel of a point of the head; false behind the camera. */
bool head_project(double px[2], const struct camera *camera, const double cam_from_head[4][4], const double head[3]);

/* The pose after a rotation d[0..2] of the camera's axes (radians) about `pivot` (camera frame, mm), then a shift d[3..5]. */
void head_moved(double out[4][4], const double cam_from_head[4][4], const double d[6], const double pivot[3]);

/* That motion to cam_from_head from another pose; what lies at `pivot` afterwards counts for the shift. */
void head_motion(double d[6], const double cam_from_head[4][4], const double from[4][4], const double pivot[3]);

#endif
