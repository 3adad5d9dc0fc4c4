#include "optics/camera.h"

#include <math.h>

#include "math/vec.h"

/* Distortion d = D(u) in normalised coordinates, and its Jacobian J = dD/du. */
static void distort(double d[2], double J[2][2], const double k[5], const double u[2])
{
	double x = u[0], y = u[1], r2 = x * x + y * y;
	double g = 1 + r2 * (k[0] + r2 * (k[1] + r2 * k[4])), dg = k[0] + r2 * (2 * k[1] + 3 * r2 * k[4]);
	d[0] = x * g + 2 * k[2] * x * y + k[3] * (r2 + 2 * x * x);
	d[1] = y * g + k[2] * (r2 + 2 * y * y) + 2 * k[3] * x * y;
	J[0][0] = g + 2 * x * x * dg + 2 * k[2] * y + 6 * k[3] * x;
	J[0][1] = J[1][0] = 2 * x * y * dg + 2 * k[2] * x + 2 * k[3] * y;
	J[1][1] = g + 2 * y * y * dg + 6 * k[2] * y + 2 * k[3] * x;
}

static bool is_straight(const struct camera *camera)
{
	for (int i = 0; i < 5; i++)
		if (camera->distortion[i])
			return false;
	return true;
}

bool camera_project(double px[2], const struct camera *camera, const double p[3])
{
	if (!(p[2] > 0))
		return false;
	double u[2] = { p[0] / p[2], p[1] / p[2] }, d[2] = { u[0], u[1] }, J[2][2];
	if (!is_straight(camera))
		distort(d, J, camera->distortion, u);
	for (int i = 0; i < 2; i++)
		px[i] = camera->center_px[i] + camera->focal_px * d[i];
	return true;
}

static void normalised(double u[2], const struct camera *camera, const double px[2])
{
	double want[2];
	for (int i = 0; i < 2; i++)
		u[i] = want[i] = (px[i] - camera->center_px[i]) / camera->focal_px;
	if (is_straight(camera))
		return;
	for (int step = 0; step < 20; step++) {
		double d[2], J[2][2];
		distort(d, J, camera->distortion, u);
		double e[2] = { want[0] - d[0], want[1] - d[1] }, det = J[0][0] * J[1][1] - J[0][1] * J[1][0];
		if (fabs(det) < 1e-9 || fabs(e[0]) + fabs(e[1]) < 1e-15)
			return;
		u[0] += (J[1][1] * e[0] - J[0][1] * e[1]) / det;
		u[1] += (J[0][0] * e[1] - J[1][0] * e[0]) / det;
	}
}

void camera_ray(double dir[3], const struct camera *camera, const double px[2])
{
	double u[2];
	normalised(u, camera, px);
	double v[3] = { u[0], u[1], 1 };
	vec_unit(dir, v);
}

void camera_undistort(double out[2], const struct camera *camera, const double px[2])
{
	double u[2];
	normalised(u, camera, px);
	for (int i = 0; i < 2; i++)
		out[i] = camera->center_px[i] + camera->focal_px * u[i];
}
