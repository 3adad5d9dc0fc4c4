/* pose: head pose from points of the mesh and their pixels (perspective n-point), and rigid motions of the head.
 * Head frame  the subject mesh's axes, mm.  Camera  x right, y down, z forward, mm.  Image  px, first centre (0.5, 0.5).
 */
#ifndef TRACK_HEAD_POSE_H
#define TRACK_HEAD_POSE_H
#include <stdbool.h>

#include "optics/camera.h"

/* Gaussian prior of the pose: mean, and standard deviations of rotations about the camera's x, y, z (radians) and
 * translations (mm) from it; INFINITY: not constrained. */
struct head_prior {
	double cam_from_head[4][4];
	double sigma[6];
	const struct head_form *form;    // what the face's form tells besides; null: nothing
};

/* What is known of motions d from a pose about a pivot (head_moved): twice the negative log likelihood is (d - best)^T info (d - best). */
struct head_form {
	double cam_from_head[4][4], pivot[3], best[6], info[6][6];
	double off;            // what it was told from fits by so much
	int n;                 // places that it was told from
};

/* One measurement: a point of the head is seen at px (line false), or on the line through px with this unit normal (line true). */
struct head_sight {
	double head[3], px[2], normal[2];
	bool line;
	bool sure;             // never treated as an outlier
	double weight;         // 1 / sigma^2, px^-2; 0: left out
};

/* Refines cam_from_head by Gauss-Newton with Geman-McClure weights of scale `robust` px (INFINITY: least squares). prior may be
 * null. camera->focal_px must be known. Returns the weighted rms of the residuals, px; NAN, cam_from_head unchanged, when the
 * points do not determine a pose. */
double head_pose_fit(double cam_from_head[4][4], int n, const struct head_sight *sights, const struct camera *camera,
                     double robust, const struct head_prior *prior);

/* What head_pose_fit() minimises: twice the negative logarithm of the pose's likelihood and prior, up to a constant. */
double head_pose_cost(const double cam_from_head[4][4], int n, const struct head_sight *sights, const struct camera *camera, double robust,
                      const struct head_prior *prior);

/* Standard deviations of rotations about the camera's x, y, z (radians) of the pose that head_pose_fit() found with these arguments, as far as the
 * weights are true. Returns false, turn undefined, when the points do not determine a pose. */
bool head_pose_sigma(double turn[3], const double cam_from_head[4][4], int n, const struct head_sight *sights, const struct camera *camera,
                     double robust, const struct head_prior *prior);

/* A point of the head (mm) in the camera frame. out may be head. */
void head_from(double out[3], const double cam_from_head[4][4], const double head[3]);

/* The inverse of head_from. */
void head_to(double out[3], const double cam_from_head[4][4], const double cam[3]);

/* How a head is turned: Fick angles (h towards its own left, v up, torsion right-handed about the line out of its face; radians), all 0 when
 * it is upright and faces along the camera's axis. */
void head_fick(double fick[3], const double cam_from_head[4][4]);

/* Pixel of a point of the head; false behind the camera. */
bool head_project(double px[2], const struct camera *camera, const double cam_from_head[4][4], const double head[3]);

/* The pose after a rotation by the vector d[0..2] (camera axes, radians) about `pivot` (camera frame, mm), then a shift d[3..5]
 * (mm). */
void head_moved(double out[4][4], const double cam_from_head[4][4], const double d[6], const double pivot[3]);

/* The inverse of head_moved: the motion d that takes the pose `from` to cam_from_head. */
void head_motion(double d[6], const double cam_from_head[4][4], const double from[4][4], const double pivot[3]);

#endif
