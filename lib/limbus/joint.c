#include "limbus/joint.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "limbus/aspect.h"

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

bool limbus_joint_pose(struct pose *pose, const struct limbus_joint *joint, const struct limbus_record *record,
                       const struct eye *eye, struct err *err)
{
	if (!limbus_pose(pose, &record->view, eye, &joint->pose, err))
		return false;
	if (joint->aspect_sigma > 0) {
		struct pose_conf moved = joint->pose;
		struct pose other;
		moved.aspect_mean += joint->aspect_sigma;
		if (!limbus_pose(&other, &record->view, eye, &moved, err))
			return false;
		double dot = 0;
		for (int i = 0; i < 3; i++)
			dot += pose->cam_from_eye[i][2] * other.cam_from_eye[i][2];
		double turn = fabs(dot) < 1 ? acos(dot) : 0;
		pose->theta_sigma = hypot(pose->theta_sigma, turn > 1 ? fabs(other.theta - pose->theta) : turn);
		pose->aspect_sigma = joint->aspect_sigma;
	}
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
