#include "limbus/joint.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "limbus/rice.h"
#include "math/vec.h"

double limbus_joint_level(const struct limbus_record *one, const struct limbus_record *other)
{
	const double x = other->view.limbus.cx - one->view.limbus.cx, y = other->view.limbus.cy - one->view.limbus.cy;
	return x >= 0 ? atan2(y, x) : atan2(-y, -x);
}

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
	bool ok = !usable || limbus_aspect(&joint->aspect, usable, views, eye, conf, err);
	if (usable)
		joint->pose.aspect_mean = joint->aspect.likeliest;
	free(views);
	return ok;
}

/* What a picture tells of a tilt: a vector as long as its square, at twice its direction. */
static void shape_of(double v[2], const struct pose *pose)
{
	const double u = pose->theta * pose->theta;
	v[0] = u * cos(2 * pose->phi);
	v[1] = u * sin(2 * pose->phi);
}

static void add_outer(double cov[2][2], const double v[2])
{
	for (int i = 0; i < 2; i++)
		for (int j = 0; j < 2; j++)
			cov[i][j] += v[i] * v[j];
}

/* Covariance of that vector by the ellipse's, and by how far the limbus's axes may be turned. With m = (q3, q4) / q2 a circle's m is tan^2(theta / 2)
 * long; near the front the vector is 4 m. */
static void shape_cov(double cov[2][2], const struct pose *pose, const struct pose_view *view, const struct pose_conf *conf)
{
	double q[ELLIPSE_N], jac[2][ELLIPSE_N] = { 0 }, m[2][2] = { 0 };
	ellipse_to_q(q, &view->limbus);
	for (int i = 0; i < 2; i++) {
		jac[i][2] = -q[3 + i] / (q[2] * q[2]);
		jac[i][3 + i] = 1 / q[2];
	}
	for (int i = 0; i < 2; i++)
		for (int j = 0; j < 2; j++)
			for (int a = 2; a < ELLIPSE_N; a++)
				for (int b = 2; b < ELLIPSE_N; b++)
					m[i][j] += jac[i][a] * jac[j][b] * view->cov_q[a][b];
	const double oval = (1 - conf->aspect_mean) / (1 + conf->aspect_mean);
	add_outer(m, (double[2]){ -2 * oval * conf->roll_sigma * sin(2 * view->level), 2 * oval * conf->roll_sigma * cos(2 * view->level) });
	// along the vector and across it
	const double root = fmax(tan(pose->theta / 2), 1e-3), theta = fmax(pose->theta, 2e-3);
	const double along = 2 * theta / (root * (1 + root * root)), across = pow(theta / root, 2), c = cos(2 * pose->phi), s = sin(2 * pose->phi);
	const double f[2][2] = { { along * c * c + across * s * s, (along - across) * c * s }, { (along - across) * c * s, along * s * s + across * c * c } };
	for (int i = 0; i < 2; i++)
		for (int j = 0; j < 2; j++) {
			cov[i][j] = 0;
			for (int a = 0; a < 2; a++)
				for (int b = 0; b < 2; b++)
					cov[i][j] += f[i][a] * m[a][b] * f[b][j];
		}
}

/* Turns the eye about the centre of its limbus until it is tilted by theta towards phi. */
static void turn_to(struct pose *pose, double theta, double phi, const struct eye *eye)
{
	double z[3], sight[3], aside[3], turn[3][3], R[3][3], was[3][3];
	for (int i = 0; i < 3; i++) {
		memcpy(was[i], pose->cam_from_eye[i], sizeof was[i]);
		z[i] = was[i][2];
		sight[i] = pose->cam_from_eye[i][3] + eye_limbus_depth(eye) * z[i];
		aside[i] = was[i][0] * cos(phi) + was[i][1] * sin(phi);
	}
	const double center[3] = { sight[0], sight[1], sight[2] };
	vec_unit(sight, sight);
	vec_add(aside, aside, -vec_dot(aside, sight), sight);
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
	pose->phi = phi < 0 ? phi + 2 * M_PI : phi;
}

/* Height over width of a circle that is tilted towards phi, against what is level, weak perspective. */
static double foreshortened(double theta, double phi)
{
	const double less = 1 - cos(theta);
	return (1 - less * pow(sin(phi), 2)) / (1 - less * pow(cos(phi), 2));
}

/* As far as the picture could be that of an eye from in front, the posterior is one hill round the front, and the tilt is its mean. Where it could not, there are two hills, one to
 * either side, and the tilt stays on the likelier one. seen: the tilt as it was measured; square_sigma: sigma of its square. */
static double one_hill(double seen, double square_sigma)
{
	return exp(-0.5 * pow(seen * seen / fmax(square_sigma, 1e-12), 2));
}

/* The tilt of an eye alone: both poses by their chances.
 * sigma  in: of theta on its own side; out: root mean square distance from the posterior
 * margin log odds of the likelier pose */
static double between_poses(double *sigma, double theta, double margin, double one)
{
	const double other = 1 / (1 + exp(margin)), mean = theta * (1 - 2 * one * other);
	*sigma = sqrt(*sigma * *sigma + one * ((1 - other) * pow(theta - mean, 2) + other * pow(theta + mean, 2)));
	return mean;
}

/* The same of one of the two eyes of a face, by what the other one says of it. */
static double between_eyes(double *sigma, double *phi, const struct fellow_said *said, double one)
{
	double mean[2];
	for (int i = 0; i < 2; i++)
		mean[i] = said->hill[i] + one * (said->all[i] - said->hill[i]);
	*sigma = sqrt(pow(said->hill_sigma, 2) + one * (pow(said->all_sigma, 2) - pow(said->hill_sigma, 2)));
	*phi = atan2(mean[1], mean[0]);
	return hypot(mean[0], mean[1]);
}

/* The other pose becomes the one that is kept. */
static void take_other(struct pose *pose)
{
	const struct pose was = *pose;
	memcpy(pose->cam_from_eye, was.other_cam_from_eye, sizeof was.cam_from_eye);
	memcpy(pose->other_cam_from_eye, was.cam_from_eye, sizeof was.cam_from_eye);
	pose->theta = was.other_theta;
	pose->phi = was.other_phi;
	pose->other_theta = was.theta;
	pose->other_phi = was.phi;
}

/* The pose were the aspect another. */
static bool moved_pose(struct pose *pose, double aspect, const struct limbus_joint *joint, const struct limbus_record *record, const struct eye *eye,
                       struct err *err)
{
	struct pose_conf conf = joint->pose;
	conf.aspect_mean = aspect;
	return limbus_pose(pose, &record->view, eye, &conf, err);
}

/* Adds what the aspect's other hills say, where the eye is tilted to another side: mean square of the angle to their axes. */
static bool add_rivals(struct pose *pose, const struct limbus_joint *joint, const struct limbus_record *record, const struct eye *eye,
                       struct err *err)
{
	double square = 0;
	for (int i = 0; i < ASPECT_RIVALS && joint->aspect.elsewhere > 0; i++) {
		struct pose other;
		double between = 0;
		if (!moved_pose(&other, joint->aspect.rival[i], joint, record, eye, err))
			return false;
		for (int k = 0; k < 3; k++)
			between += pose->cam_from_eye[k][2] * other.cam_from_eye[k][2];
		square += pow(acos(fmin(between, 1)), 2) / ASPECT_RIVALS;
	}
	const double elsewhere = joint->aspect.elsewhere;
	pose->theta_sigma = sqrt((1 - elsewhere) * pow(pose->theta_sigma, 2) + elsewhere * square);
	return true;
}

/* The likelier pose, and what the picture tells of its tilt. square_sigma: of the tilt's square, by all that the pose rests on. */
static bool tell(struct fellow_tilt *tilt, struct pose *pose, double *square_sigma, const struct limbus_joint *joint, const struct limbus_record *record,
                 const struct eye *eye, struct err *err)
{
	if (!limbus_pose(pose, &record->view, eye, &joint->pose, err))
		return false;
	*tilt = (struct fellow_tilt){ .seen = pose->theta, .towards = pose->phi, .prior = joint->pose.tilt_sigma, .level = record->view.level, .radius = eye->limbus_radius };
	memcpy(tilt->reach, record->view.reach, sizeof tilt->reach);
	tilt->margin = pose->margin;
	if (isfinite(pose->margin))
		tilt->margin -= pose_opening(&record->view, pose->theta, pose->phi, eye, &joint->pose) - pose_opening(&record->view, pose->other_theta, pose->other_phi, eye, &joint->pose);
	tilt->margin = fmin(tilt->margin, 100);
	*square_sigma = rice_square_sigma(pose->theta, pose->theta_sigma);
	shape_cov(tilt->cov, pose, &record->view, &joint->pose);
	for (int i = 0; i < 3; i++)
		tilt->place[i] = pose->cam_from_eye[i][3] + eye_limbus_depth(eye) * pose->cam_from_eye[i][2];
	if (joint->aspect.sigma > 0) {
		struct pose other;
		double v[2], w[2];
		if (!moved_pose(&other, joint->aspect.likeliest + joint->aspect.sigma, joint, record, eye, err))
			return false;
		shape_of(v, pose);
		shape_of(w, &other);
		for (int i = 0; i < 2; i++)
			tilt->shift[i] = w[i] - v[i];
		*square_sigma = hypot(*square_sigma, hypot(tilt->shift[0], tilt->shift[1]));
		pose->aspect_sigma = aspect_spread(&joint->aspect);
	}
	return true;
}

bool limbus_joint_tilt(struct fellow_tilt *tilt, const struct limbus_joint *joint, const struct limbus_record *record, const struct eye *eye, struct err *err)
{
	struct pose pose;
	double sigma;
	return tell(tilt, &pose, &sigma, joint, record, eye, err);
}

bool limbus_joint_pose(struct pose *pose, const struct limbus_joint *joint, const struct limbus_record *record, const struct fellow_tilt *other,
                       const struct eye *eye, struct err *err)
{
	struct fellow_tilt tilt;
	struct fellow_said said;
	double sigma, theta;
	if (!tell(&tilt, pose, &sigma, joint, record, eye, err))
		return false;
	const bool both = other && fellow_tilt_of(&said, &tilt, other, &joint->pose.fellow, &joint->pose.opening);
	if (both)
		pose->margin = said.margin;
	if (both && said.turned && pose->other_theta > 0)  // 0: there is none
		take_other(pose);
	const double seen = pose->theta, from = pose->phi, one = one_hill(seen, sigma);
	double towards = from;
	if (both && said.resolved)
		theta = between_eyes(&pose->theta_sigma, &towards, &said, one);
	else {
		add_outer(tilt.cov, tilt.shift);
		rice_tilt(&theta, &pose->theta_sigma, seen, sigma, joint->pose.tilt_sigma);
		pose->theta_sigma = fmax(pose->theta_sigma, rice_astray(theta, seen, towards, tilt.cov, joint->pose.tilt_sigma));
		theta = between_poses(&pose->theta_sigma, theta, pose->margin, one);
	}
	if (joint->aspect.sigma > 0)
		pose->aspect *= foreshortened(seen, from - record->view.level) / foreshortened(theta, towards - record->view.level);
	turn_to(pose, theta, towards, eye);
	return add_rivals(pose, joint, record, eye, err);
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
	fit.rough = r->rough;
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
