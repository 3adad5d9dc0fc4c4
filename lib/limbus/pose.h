/* pose: position and orientation of the eye from the ellipses of one photograph (iris paper, section 3, eq. 9).
 * The limbus is an ellipse in space (half axes r and r * aspect along x and y of the eye frame) seen in perspective; the pupil is
 * seen through the cornea. Non-linear least squares (Ceres) estimate axis, position and pupil; anatomy that one photograph does
 * not determine has Gaussian priors. A conic has two poses (tilted to either side): both are fitted, the likelier one is kept.
 */
#ifndef LIMBUS_POSE_H
#define LIMBUS_POSE_H
#include "anatomy/eye.h"
#include "limbus/fellow.h"
#include "limbus/opening.h"
#include "math/ellipse.h"

enum { POSE_RAMP = 360 };  // samples around the limbus

struct pose_conf {
	double pupil_offset_sigma;  // mm: pupil centre against the optical axis, each way
	double depth_sigma;         // mm: iris plane against eye.iris_depth_mm
	double pupil_floor;         // an irregular margin: sigma of its centre, share of the pupil's semi-axis
	double aspect_mean, aspect_sigma;  // prior of vertical / horizontal; sigma 0: declared
	double roll_sigma;          // rad: of the limbus's axes against what is level; 0: level
	double tilt_sigma;          // rad: of eyes round the front; 0: any direction of sight is as likely
	double side_trust;          // what log likelihoods of ramp and lean count: light errs alike all round an eye, and they do not know it
	struct opening_conf opening;
	struct fellow_conf fellow;  // how alike both eyes of a face look
};

struct pose_view {
	struct camera camera;       // focal_px finite
	struct ellipse limbus;
	double cov_q[ELLIPSE_N][ELLIPSE_N];
	bool has_pupil;
	struct ellipse pupil;
	double pupil_sigma;         // px, of its centre, each way
	double ramp[POSE_RAMP];     // width of the limbal ramp at equal steps of the eccentric angle, px; 0: not known
	double reach[2];            // how far what shows between the lids reaches to both sides, semi-axes (opening.h); 0: not known
	double level;               // rad: of what is level for the head, against the picture's rows: the line through both eyes; 0: not known
	double lean[2];             // log likelihood of a tilt towards +x, +y against the opposite (limbus/propose/lean.h); 0: unknown
};

struct pose {
	double cam_from_eye[4][4];
	double theta, phi;          // radians
	double theta_sigma;
	double theta_weak;          // arccos(b/a)
	double cost;                // ½ chi² with the terms of ramp and lean: minus log likelihood
	double margin;              // cost of the other pose minus this one's: log likelihood ratio; INFINITY: there is no other
	double other_theta, other_phi, other_cam_from_eye[4][4];
	double aspect, aspect_sigma;
	double pupil_offset[2], iris_depth;  // mm
};

/* Log likelihood, up to a constant, of a tilt of theta towards phi by where the limbus lies between the corners of the lids. */
double pose_opening(const struct pose_view *view, double theta, double phi, const struct eye *eye, const struct pose_conf *conf);

/* Fits the pose of one view. False, err set, when no pose fits or the ellipse is none after undoing the lens distortion. */
bool limbus_pose(struct pose *pose, const struct pose_view *view, const struct eye *eye, const struct pose_conf *conf,
                 struct err *err);

/* A camera 1000 mm away, for photographs whose camera is not known: weak perspective. source: CAMERA_NONE. */
struct camera pose_nominal_camera(const struct ellipse *limbus, const struct eye *eye, int width, int height);

#endif
