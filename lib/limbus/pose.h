/* limbus_pose: where the eye is and which way it looks, from the ellipses of one photograph.
 * The limbus is an ellipse in space (half axes r and r * aspect, x and y of the eye frame) seen in perspective; the
 * pupil is seen through the cornea. Ceres finds axis, place and pupil; anatomy that one photograph does not tell is
 * held by priors. A conic has two poses (tilted this way or that): both are fitted, the likelier one is kept.
 */
#ifndef LIMBUS_POSE_H
#define LIMBUS_POSE_H
#include "anatomy/eye.h"
#include "math/ellipse.h"

enum { POSE_RAMP = 360 };  // samples around the limbus

struct pose_conf {
	double pupil_offset_sigma;  // mm: pupil centre against the optical axis, each way
	double depth_sigma;         // mm: iris plane against eye.iris_depth_mm
	double pupil_floor;         // an irregular margin: sigma of its centre, share of the pupil's semi-axis
	double aspect_mean, aspect_sigma;  // prior of vertical / horizontal; sigma 0: declared
};

struct pose_view {
	struct camera camera;       // focal_px finite
	struct ellipse limbus;
	double cov_q[ELLIPSE_N][ELLIPSE_N];
	bool has_pupil;
	struct ellipse pupil;
	double pupil_sigma;         // px, of its centre, each way
	double ramp[POSE_RAMP];     // width of the limbal ramp at equal steps of the eccentric angle, px; 0: not known
	double lean[2];             // log likelihood of a tilt towards +x, +y against the opposite (limbus/propose/lean.h); 0: unknown
};

struct pose {
	double cam_from_eye[4][4];
	double theta, phi;          // radians
	double theta_sigma;
	double theta_weak;          // arccos(b/a)
	double cost;                // ½ chi²
	double margin;              // ½ chi² of the other pose less this one's: log likelihood ratio
	double other_theta, other_phi, other_cam_from_eye[4][4];
	double aspect, aspect_sigma;
	double pupil_offset[2], iris_depth;  // mm
};

/* False, err set, when no pose fits. */
bool limbus_pose(struct pose *pose, const struct pose_view *view, const struct eye *eye, const struct pose_conf *conf,
                 struct err *err);

/* A camera 1000 mm away for photographs whose camera is not known (weak perspective). */
struct camera pose_nominal_camera(const struct ellipse *limbus, const struct eye *eye, int width, int height);

#endif
