#include "limbus/pose.h"

#include <math.h>
#include <string.h>

#include "bridge/nls.h"
#include "limbus/ramp.h"
#include "limbus/tilt.h"
#include "math/chol.h"
#include "math/ellipse_fit.h"
#include "math/vec.h"
#include "optics/lightpath/lightpath.h"

/* Parameters: axis (rotation vector of +z onto the eye's z, about x and y), limbus centre in the image (offset from
 * the ellipse's, in units of its semi-axis), log of its distance, pupil offset (mm), iris depth (mm), aspect, roll: how far the limbus's longer axis
 * is turned out of the eye's x. */
enum { AX, AY, CX, CY, LOGZ, DX, DY, DZ, ASPECT, ROLL, N };
enum { R_ELLIPSE = 0, R_PUPIL = 5, R_PRIOR = 7, M = 12, MARGIN_POINTS = 8 };
static const double NOMINAL_MM = 1000;

struct problem {
	const struct pose_view *view;
	const struct eye *eye;
	const struct pose_conf *conf;
	struct cornea cornea;
	double limbus_depth, focal, center[2];  // focal and centre in units of the semi-axis, from the ellipse's centre
	double q[ELLIPSE_N], chol[ELLIPSE_N][ELLIPSE_N];
	double pupil[2], pupil_sigma, pupil_radius;
	double aspect_sigma, roll_sigma;
};

static void frame(double R[3][3], double limbus[3], double apex[3], const struct problem *p, const double *x)
{
	double angle = hypot(x[AX], x[AY]), k = angle > 1e-9 ? sin(angle) / angle : 1;
	double z[3] = { k * x[AX], k * x[AY], cos(angle) };
	mat_smallest_rotation(R, (double[3]){ 0, 0, 1 }, z);
	limbus[2] = exp(x[LOGZ]);
	limbus[0] = (x[CX] - p->center[0]) / p->focal * limbus[2];
	limbus[1] = (x[CY] - p->center[1]) / p->focal * limbus[2];
	vec_add(apex, limbus, -p->limbus_depth, z);
}

/* Conic of the limbus: M = K [r X, r aspect Y, C], X and Y turned by the roll, conic M^-T diag(1, 1, -1) M^-1. */
static bool project_limbus(double q[ELLIPSE_N], const struct problem *p, const double R[3][3], const double C[3],
                           double aspect, double roll)
{
	double m[3][3], inv[3][3], k[6];
	const double r = p->eye->limbus_radius, co = cos(roll), si = sin(roll);
	for (int j = 0; j < 3; j++) {
		double v[3];
		for (int i = 0; i < 3; i++)
			v[i] = j == 0 ? r * (co * R[i][0] + si * R[i][1]) : j == 1 ? r * aspect * (co * R[i][1] - si * R[i][0]) : C[i];
		m[0][j] = p->focal * v[0] + p->center[0] * v[2];
		m[1][j] = p->focal * v[1] + p->center[1] * v[2];
		m[2][j] = v[2];
	}
	double c0[3] = { m[0][0], m[1][0], m[2][0] }, c1[3] = { m[0][1], m[1][1], m[2][1] },
	       c2[3] = { m[0][2], m[1][2], m[2][2] };
	vec_cross(inv[0], c1, c2);
	vec_cross(inv[1], c2, c0);
	vec_cross(inv[2], c0, c1);
	double s[3][3];
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++)
			s[i][j] = inv[0][i] * inv[0][j] + inv[1][i] * inv[1][j] - inv[2][i] * inv[2][j];
	double scale = fabs(s[0][0]) + fabs(s[1][1]);
	k[0] = s[0][0] / scale;
	k[1] = 2 * s[0][1] / scale;
	k[2] = s[1][1] / scale;
	k[3] = 2 * s[0][2] / scale;
	k[4] = 2 * s[1][2] / scale;
	k[5] = s[2][2] / scale;
	struct ellipse e;
	if (!ellipse_from_conic(&e, k))
		return false;
	ellipse_to_q(q, &e);
	return true;
}

/* Centre of the pupil's margin as it is seen through the cornea: the mean of points on it. */
static bool project_pupil(double px[2], const struct problem *p, const double R[3][3], const double apex[3],
                          const double *x)
{
	double camera[3], minus[3] = { -apex[0], -apex[1], -apex[2] };
	mat_tvec(camera, R, minus);
	px[0] = px[1] = 0;
	for (int i = 0; i < MARGIN_POINTS; i++) {
		double t = 2 * M_PI * i / MARGIN_POINTS, K[3], c[3];
		double P[3] = { x[DX] + p->pupil_radius * cos(t), x[DY] + p->pupil_radius * sin(t), x[DZ] };
		if (lightpath_solve(K, &p->cornea, P, camera) != LIGHTPATH_OK)
			return false;
		mat_vec(c, R, K);
		vec_add(c, c, 1, apex);
		px[0] += (p->focal * c[0] / c[2] + p->center[0]) / MARGIN_POINTS;
		px[1] += (p->focal * c[1] / c[2] + p->center[1]) / MARGIN_POINTS;
	}
	return true;
}

/* A problem, and where the pupil was seen last: differences along the aspect and the roll leave it there. */
struct seen_pupil { const struct problem *problem; bool any; double x[ASPECT], px[2]; };

static bool see_pupil(double px[2], struct seen_pupil *last, const double R[3][3], const double apex[3], const double *x)
{
	_Static_assert((int)ASPECT + 2 == N && (int)ROLL + 1 == N, "of both the pupil knows nothing");
	if (!last->any || memcmp(last->x, x, sizeof last->x)) {
		last->any = project_pupil(last->px, last->problem, R, apex, x);
		memcpy(last->x, x, sizeof last->x);
	}
	memcpy(px, last->px, sizeof last->px);
	return last->any;
}

static bool residuals(void *ctx, const double *x, double *r, double *J)
{
	struct seen_pupil *last = ctx;
	const struct problem *p = last->problem;
	(void)J;
	double R[3][3], limbus[3], apex[3], q[ELLIPSE_N], px[2];
	if (hypot(x[AX], x[AY]) > 1.4)
		return false;
	frame(R, limbus, apex, p, x);
	if (!project_limbus(q, p, R, limbus, x[ASPECT], x[ROLL]))
		return false;
	for (int i = 0; i < ELLIPSE_N; i++) {  // L^-1 (q - observed)
		double sum = q[i] - p->q[i];
		for (int j = 0; j < i; j++)
			sum -= p->chol[i][j] * r[R_ELLIPSE + j];
		r[R_ELLIPSE + i] = sum / p->chol[i][i];
	}
	r[R_PUPIL] = r[R_PUPIL + 1] = 0;
	if (p->view->has_pupil) {
		if (!see_pupil(px, last, R, apex, x))
			return false;
		for (int i = 0; i < 2; i++)
			r[R_PUPIL + i] = (px[i] - p->pupil[i]) / p->pupil_sigma;
	}
	r[R_PRIOR] = x[DX] / p->conf->pupil_offset_sigma;
	r[R_PRIOR + 1] = x[DY] / p->conf->pupil_offset_sigma;
	r[R_PRIOR + 2] = (x[DZ] - p->eye->iris_depth) / p->conf->depth_sigma;
	r[R_PRIOR + 3] = (x[ASPECT] - p->conf->aspect_mean) / p->aspect_sigma;
	r[R_PRIOR + 4] = (x[ROLL] - p->view->level) / p->roll_sigma;
	return true;
}

/* The ellipse and the pupil as an undistorted picture would show them, relative to the ellipse's centre, in units of
 * its major semi-axis. */
static bool set_up(struct problem *p, const struct pose_view *view, const struct eye *eye, const struct pose_conf *conf)
{
	enum { POINTS = 48 };
	double pts[POINTS][2], n[2], seen[2];
	struct ellipse e;
	for (int i = 0; i < POINTS; i++) {
		ellipse_point(seen, n, &view->limbus, 2 * M_PI * i / POINTS);
		camera_undistort(pts[i], &view->camera, seen);
	}
	if (!ellipse_fit_direct(&e, POINTS, pts, 0))
		return false;
	const double a = e.a;
	*p = (struct problem){ .view = view, .eye = eye, .conf = conf, .cornea = eye_cornea(eye),
	                       .limbus_depth = eye_limbus_depth(eye), .focal = view->camera.focal_px / a,
	                       .aspect_sigma = fmax(conf->aspect_sigma, 1e-6), .roll_sigma = fmax(conf->roll_sigma, 1e-6) };
	p->cornea.rim *= 1.05;  // sight past the middle of the ramp
	for (int i = 0; i < 2; i++)
		p->center[i] = (view->camera.center_px[i] - (i ? e.cy : e.cx)) / a;
	struct ellipse unit = { 0, 0, 1, e.b / a, e.angle };
	ellipse_to_q(p->q, &unit);
	for (int i = 0; i < ELLIPSE_N; i++)
		for (int j = 0; j < ELLIPSE_N; j++)
			p->chol[i][j] = view->cov_q[i][j] / (a * a);
	double unused[ELLIPSE_N] = { 0 };
	if (!chol_solve(ELLIPSE_N, ELLIPSE_N, &p->chol[0][0], unused))
		return false;
	if (view->has_pupil) {
		double c[2] = { view->pupil.cx, view->pupil.cy };
		camera_undistort(seen, &view->camera, c);
		p->pupil[0] = (seen[0] - e.cx) / a;
		p->pupil[1] = (seen[1] - e.cy) / a;
		p->pupil_sigma = hypot(view->pupil_sigma, conf->pupil_floor * view->pupil.a) / a;
		p->pupil_radius = 0.88 * view->pupil.a / a * eye->limbus_radius;  // the cornea magnifies by about 1.13
	}
	return true;
}

/* Start tilted by `tilt` towards `phi` against the line of sight to the ellipse's centre. */
static void start(double *x, const struct problem *p, double tilt, double phi)
{
	double R[3][3], z[3];
	limbus_sight(R, p->center, p->focal);
	double local[3] = { sin(tilt) * cos(phi), sin(tilt) * sin(phi), cos(tilt) };
	mat_vec(z, R, local);
	double angle = acos(fmin(z[2], 1)), k = angle > 1e-9 ? angle / sin(angle) : 1;
	x[AX] = k * z[0];
	x[AY] = k * z[1];
	x[CX] = x[CY] = 0;
	x[LOGZ] = log(p->focal * p->eye->limbus_radius);
	x[DX] = x[DY] = 0;
	x[DZ] = p->eye->iris_depth;
	x[ASPECT] = p->conf->aspect_mean;
	x[ROLL] = p->view->level;
}

struct solution {
	double x[N], cost, cov[N][N];
};

static bool solve(struct solution *s, const struct problem *p, double tilt, double phi, struct err *err)
{
	const struct nls_conf conf = { .max_iter = 60, .ftol = 1e-12, .gtol = 1e-12, .xtol = 1e-10, .numeric = true };
	struct nls_result result;
	struct seen_pupil last = { .problem = p };
	start(s->x, p, tilt, phi);
	if (!nls_solve(&result, N, s->x, 0, 0, M, residuals, &last, &conf, &s->cov[0][0], err))
		return false;
	s->cost = result.cost;
	return true;
}

/* Angle between the axis and the direction to the camera at the limbus, and which way it goes in the eye's x, y. */
static void angles(double *theta, double *phi, const struct problem *p, const double *x)
{
	double R[3][3], limbus[3], apex[3], to[3];
	frame(R, limbus, apex, p, x);
	for (int i = 0; i < 3; i++)
		limbus[i] = -limbus[i];
	mat_tvec(to, R, limbus);
	*theta = atan2(hypot(to[0], to[1]), -to[2]);
	*phi = atan2(to[1], to[0]);
	if (*phi < 0)
		*phi += 2 * M_PI;
}

static double sigma_theta(const struct problem *p, const struct solution *s)
{
	double g[N], var = 0, phi, theta;
	angles(&theta, &phi, p, s->x);
	for (int i = 0; i < N; i++) {
		double up[N], hi, lo;
		memcpy(up, s->x, sizeof up);
		up[i] += 1e-5;
		angles(&hi, &phi, p, up);
		up[i] -= 2e-5;
		angles(&lo, &phi, p, up);
		g[i] = (hi - lo) / 2e-5;
	}
	for (int i = 0; i < N; i++)
		for (int j = 0; j < N; j++)
			var += g[i] != 0 && g[j] != 0 ? g[i] * g[j] * s->cov[i][j] : 0;
	/* Near the front the picture tells the square of theta: its sigma is taken through the root. */
	double linear = sqrt(fmax(var, 0));
	return fmin(linear, sqrt(theta * theta + 2 * theta * linear) - theta + 1e-4);
}

static void transform(double m[4][4], const struct problem *p, const double *x)
{
	double R[3][3], limbus[3], apex[3];
	frame(R, limbus, apex, p, x);
	for (int i = 0; i < 3; i++) {
		memcpy(m[i], R[i], sizeof R[i]);
		m[i][3] = apex[i];
		m[3][i] = 0;
	}
	m[3][3] = 1;
}

static void fill(struct pose *pose, const struct problem *p, const struct solution *s)
{
	transform(pose->cam_from_eye, p, s->x);
	angles(&pose->theta, &pose->phi, p, s->x);
	pose->theta_sigma = sigma_theta(p, s);
	pose->cost = s->cost;
	pose->aspect = s->x[ASPECT];
	pose->aspect_sigma = sqrt(s->cov[ASPECT][ASPECT]);
	pose->pupil_offset[0] = s->x[DX];
	pose->pupil_offset[1] = s->x[DY];
	pose->iris_depth = s->x[DZ];
}

double pose_opening(const struct pose_view *view, double theta, double phi, const struct eye *eye, const struct pose_conf *conf)
{
	// phi is where the camera lies from the axis
	return opening_known(view->reach, &conf->opening) ? log(opening_likelihood(view->reach, -theta * cos(phi - view->level), eye->limbus_radius, &conf->opening)) : 0;
}

bool limbus_pose(struct pose *pose, const struct pose_view *view, const struct eye *eye, const struct pose_conf *conf,
                 struct err *err)
{
	struct problem p;
	if (!set_up(&p, view, eye, conf))
		return err_set(err, "the limbus is no ellipse once the lens distortion is undone");
	const double ratio = fmin(view->limbus.b / view->limbus.a, 1);
	double tilt, across;
	struct ellipse e;
	ellipse_from_q(&e, p.q);
	limbus_tilt(&tilt, &across, &e, p.center, p.focal, conf->aspect_mean, view->level);
	tilt = fmax(tilt, 0.02);
	struct solution s[2];
	bool ok[2];
	struct err errs[2] = { 0 };
#pragma omp parallel for schedule(static, 1)
	for (int i = 0; i < 2; i++)
		ok[i] = solve(&s[i], &p, tilt, across + i * M_PI, &errs[i]);
	if (!ok[0] && !ok[1])
		return err_set(err, "no pose of the eye fits the ellipses: %s", errs[1].msg);
	for (int i = 0; i < 2; i++) {
		double theta, phi = 0;
		if (ok[i])
			angles(&theta, &phi, &p, s[i].x);
		if (!ok[i])
			continue;
		double m[4][4];
		transform(m, &p, s[i].x);
		s[i].cost += conf->side_trust * (ramp_cost(view, m, eye) - (view->lean[0] * cos(phi) + view->lean[1] * sin(phi)) / 2);
		s[i].cost -= pose_opening(view, theta, phi, eye, conf);
	}
	int best = ok[0] && (!ok[1] || s[0].cost <= s[1].cost) ? 0 : 1;
	*pose = (struct pose){ .theta_weak = acos(ratio), .margin = INFINITY };
	fill(pose, &p, &s[best]);
	if (ok[1 - best]) {
		angles(&pose->other_theta, &pose->other_phi, &p, s[1 - best].x);
		transform(pose->other_cam_from_eye, &p, s[1 - best].x);
		pose->margin = s[1 - best].cost - s[best].cost;
	}
	return true;
}

struct camera pose_nominal_camera(const struct ellipse *limbus, const struct eye *eye, int width, int height)
{
	return (struct camera){ .focal_px = limbus->a / eye->limbus_radius * NOMINAL_MM,
	                        .center_px = { width / 2.0, height / 2.0 }, .source = CAMERA_NONE };
}
