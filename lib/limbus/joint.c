#include "limbus/joint.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "limbus/aspect.h"
#include "limbus/rice.h"
#include "math/vec.h"

bool limbus_joint(struct limbus_joint *joint, int n, const struct limbus_record records[n], const struct eye *eye,
                  const struct pose_conf *conf, struct err *err)
{
	*joint = (struct limbus_joint){ .pose = *conf };
	joint->pose.aspect_sigma = 0;
	if (isfinite(eye->limbus_aspect)) {
		joint->pose.aspect_mean = eye->limbus_aspect;
		return true;
	}
	struct pose_view *views = mem_new((size_t)n + 1, sizeof *views);
	int usable = 0;
	for (int i = 0; i < n; i++)
		if (records[i].ok)
			views[usable++] = records[i].view;
	bool ok = !usable || limbus_aspect(&joint->pose.aspect_mean, &joint->aspect_sigma, usable, views, eye, conf, err);
	free(views);
	return ok;
}

/* How far the tilts of two poses are apart as the picture tells them: vectors of its square and twice its direction. */
static double shapes_apart(const struct pose *a, const struct pose *b)
{
	const double u = a->theta * a->theta, v = b->theta * b->theta;
	return hypot(v * cos(2 * b->phi) - u * cos(2 * a->phi), v * sin(2 * b->phi) - u * sin(2 * a->phi));
}

/* Turns the eye about the centre of its limbus until it is tilted by theta, the same way. */
static void turn_to(struct pose *pose, double theta, const struct eye *eye)
{
	double z[3], sight[3], aside[3], turn[3][3], R[3][3], was[3][3];
	for (int i = 0; i < 3; i++) {
		memcpy(was[i], pose->cam_from_eye[i], sizeof was[i]);
		z[i] = was[i][2];
		sight[i] = pose->cam_from_eye[i][3] + eye_limbus_depth(eye) * z[i];
	}
	const double center[3] = { sight[0], sight[1], sight[2] };
	vec_unit(sight, sight);
	vec_add(aside, z, -vec_dot(z, sight), sight);
	if (!(vec_norm(aside) > 1e-9))
		return;
	vec_unit(aside, aside);
	double to[3] = { 0 };
	vec_add(to, to, cos(theta), sight);
	vec_add(to, to, sin(theta), aside);
	mat_smallest_rotation(turn, z, to);
	mat_mul(R, turn, was);
	for (int i = 0; i < 3; i++) {
		memcpy(pose->cam_from_eye[i], R[i], sizeof R[i]);
		pose->cam_from_eye[i][3] = center[i] - eye_limbus_depth(eye) * to[i];
	}
	pose->theta = theta;
}

bool limbus_joint_pose(struct pose *pose, const struct limbus_joint *joint, const struct limbus_record *record,
                       const struct eye *eye, struct err *err)
{
	if (!limbus_pose(pose, &record->view, eye, &joint->pose, err))
		return false;
	// of the square of the tilt, which is what a shape tells
	double sigma = pow(pose->theta + pose->theta_sigma, 2) - pow(pose->theta, 2);
	if (joint->aspect_sigma > 0) {
		struct pose_conf moved = joint->pose;
		struct pose other;
		moved.aspect_mean += joint->aspect_sigma;
		if (!limbus_pose(&other, &record->view, eye, &moved, err))
			return false;
		sigma = hypot(sigma, shapes_apart(pose, &other));
		pose->aspect_sigma = joint->aspect_sigma;
	}
	double theta;
	rice_tilt(&theta, &pose->theta_sigma, pose->theta, sigma, joint->pose.tilt_sigma);
	turn_to(pose, theta, eye);
	return true;
}

/* Share of each sector's edge points that are in sight (used or seen). */
static void seen_of(double seen[FIT_SECTORS], const struct limbus_record *r)
{
	double all[FIT_SECTORS] = { 0 };
	memset(seen, 0, FIT_SECTORS * sizeof *seen);
	for (int i = 0; i < ARCS; i++) {
		double phi = atan2(r->point[i][1] - r->view.limbus.cy, r->point[i][0] - r->view.limbus.cx) / (2 * M_PI);
		int at = (int)((phi < 0 ? phi + 1 : phi) * FIT_SECTORS) % FIT_SECTORS;
		all[at]++;
		seen[at] += r->state[i] != ARC_HIDDEN;
	}
	for (int i = 0; i < FIT_SECTORS; i++)
		seen[i] = all[i] > 0 ? seen[i] / all[i] : 0;
}

struct fit limbus_joint_fit(const struct limbus_record *r, const struct pose *pose)
{
	struct fit fit = { .ok = r->ok, .width = r->width, .height = r->height };
	memcpy(fit.reason, r->reason, sizeof fit.reason);
	if (!r->ok)
		return fit;
	fit.limbus = r->view.limbus;
	fit.pupil = r->view.pupil;
	fit.has_pupil = r->view.has_pupil;
	ellipse_sigma(fit.ellipse_sigma, &fit.limbus, r->view.cov_q);
	memcpy(fit.cam_from_eye, pose->cam_from_eye, sizeof fit.cam_from_eye);
	fit.theta = pose->theta;
	fit.phi = pose->phi;
	fit.theta_sigma = pose->theta_sigma;
	fit.coverage = r->coverage;
	seen_of(fit.seen, r);
	fit.rms_px = r->rms;
	fit.edge_sigma_px = r->blur;
	fit.camera = r->view.camera;
	fit.limbus_aspect = pose->aspect;
	fit.limbus_aspect_sigma = pose->aspect_sigma;
	return fit;
}
