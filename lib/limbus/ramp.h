/* ramp: the likelihood of a pose given the width of the limbal ramp around the iris.
 * The ramp lies on the slope of the cornea: turned to the camera on the near side, it looks wider there; on the far
 * side it is seen edge-on and looks sharper. This separates the two poses of one ellipse, and a tilted eye from one
 * whose limbus is no circle.
 */
#ifndef LIMBUS_RAMP_H
#define LIMBUS_RAMP_H
#include "limbus/pose.h"

/* Minus log likelihood, up to a constant, of view->ramp under the pose. */
double ramp_cost(const struct pose_view *view, const double cam_from_eye[4][4], const struct eye *eye);

#endif
