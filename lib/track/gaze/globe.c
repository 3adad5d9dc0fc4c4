#include "track/gaze/globe.h"

#include <math.h>

#include "math/ellipse_fit.h"
#include "math/vec.h"

void gaze_rotation(double head_from_eye[3][3], const double fick[3])
{
	double ch = cos(fick[0]), sh = sin(fick[0]), cv = cos(fick[1]), sv = sin(fick[1]);
	double ct = cos(fick[2]), st = sin(fick[2]);
	double x[3] = { ch, 0, -sh }, y[3] = { -sh * sv, cv, -ch * sv }, z[3] = { sh * cv, sv, ch * cv };
	for (int i = 0; i < 3; i++) {
		head_from_eye[i][0] = ct * x[i] + st * y[i];
		head_from_eye[i][1] = ct * y[i] - st * x[i];
		head_from_eye[i][2] = z[i];
	}
}

double gaze_plane(const struct gaze_globe *globe)
{
	double square = globe->radius * globe->radius - globe->limbus * globe->limbus;
	return square > 0 ? sqrt(square) : 0;
}

static void to_camera(double out[3], const struct gaze_view *view, const double p[3])
{
	for (int i = 0; i < 3; i++)
		out[i] = vec_dot(view->cam_from_head[i], p) + view->cam_from_head[i][3];
}

bool gaze_pixel_of(double px[2], const struct gaze_globe *globe, const struct gaze_view *view, double R[3][3], const double point_in_eye[3])
{
	double p[3], cam[3];
	mat_vec(p, R, point_in_eye);
	vec_add(p, p, 1, globe->center);
	to_camera(cam, view, p);
	return camera_project(px, &view->camera, cam);
}

bool gaze_pixel(double px[2], const struct gaze_globe *globe, const struct gaze_view *view, const double fick[3],
                const double point_in_eye[3])
{
	double R[3][3];
	gaze_rotation(R, fick);
	return gaze_pixel_of(px, globe, view, R, point_in_eye);
}

/* d px / d point in camera, by differences a hundredth of a millimetre wide: exact to 1e-9 for any lens. */
static void pixel_slope(double J[2][3], const struct gaze_view *view, const double cam[3])
{
	for (int k = 0; k < 3; k++) {
		double lo[3] = { cam[0], cam[1], cam[2] }, hi[3] = { cam[0], cam[1], cam[2] }, a[2], b[2];
		lo[k] -= 0.005;
		hi[k] += 0.005;
		camera_project(a, &view->camera, lo);
		camera_project(b, &view->camera, hi);
		for (int i = 0; i < 2; i++)
			J[i][k] = (b[i] - a[i]) / 0.01;
	}
}

/* d(point in head) by each parameter, as columns. */
static void point_slopes(double d[GAZE_N][3], const struct gaze_globe *globe, double R[3][3],
                         const double fick[2], double c, double s)
{
	double plane = gaze_plane(globe), safe = fmax(plane, 1e-6);
	double q[3] = { globe->limbus * c, globe->limbus * s, plane }, ch = cos(fick[0]), sh = sin(fick[0]);
	double rel[3];
	mat_vec(rel, R, q);
	// A turn by dh is about the head's y; one by dv is about minus the turned x axis.
	d[GAZE_H][0] = rel[2];
	d[GAZE_H][1] = 0;
	d[GAZE_H][2] = -rel[0];
	vec_cross(d[GAZE_V], (double[3]){ -ch, 0, sh }, rel);
	for (int k = 0; k < 3; k++)
		for (int i = 0; i < 3; i++)
			d[GAZE_X + k][i] = i == k;
	for (int i = 0; i < 3; i++) {
		d[GAZE_RADIUS][i] = R[i][2] * globe->radius / safe;
		d[GAZE_LIMBUS][i] = R[i][0] * c + R[i][1] * s - R[i][2] * globe->limbus / safe;
	}
}

bool gaze_arc(struct gaze_arc *arc, const struct gaze_globe *globe, const struct gaze_view *view, double R[3][3],
              const double fick[2], double angle, bool with_row)
{
	double c = cos(angle), s = sin(angle), p[3], along[3], cam[3], J[2][3], t[2];
	mat_vec(p, R, (double[3]){ globe->limbus * c, globe->limbus * s, gaze_plane(globe) });
	mat_vec(along, R, (double[3]){ -s, c, 0 });
	vec_add(p, p, 1, globe->center);
	to_camera(cam, view, p);
	if (!camera_project(arc->p, &view->camera, cam))
		return false;
	pixel_slope(J, view, cam);
	double turn[3];
	for (int i = 0; i < 3; i++)
		turn[i] = vec_dot(view->cam_from_head[i], along);
	for (int i = 0; i < 2; i++)
		t[i] = vec_dot(J[i], turn);
	double length = hypot(t[0], t[1]), out[3], n[2] = { t[1] / length, -t[0] / length };
	for (int i = 0; i < 3; i++)
		out[i] = (R[0][0] * view->cam_from_head[i][0] + R[1][0] * view->cam_from_head[i][1]
		          + R[2][0] * view->cam_from_head[i][2]) * c
		         + (R[0][1] * view->cam_from_head[i][0] + R[1][1] * view->cam_from_head[i][1]
		            + R[2][1] * view->cam_from_head[i][2]) * s;
	double side = n[0] * vec_dot(J[0], out) + n[1] * vec_dot(J[1], out) < 0 ? -1 : 1;
	arc->normal[0] = side * n[0];
	arc->normal[1] = side * n[1];
	if (!with_row)
		return true;
	double d[GAZE_N][3], along_normal[3];
	point_slopes(d, globe, R, fick, c, s);
	for (int k = 0; k < 3; k++) {
		along_normal[k] = 0;
		for (int i = 0; i < 3; i++)
			along_normal[k] += (arc->normal[0] * J[0][i] + arc->normal[1] * J[1][i]) * view->cam_from_head[i][k];
	}
	for (int k = 0; k < GAZE_N; k++)
		arc->row[k] = vec_dot(along_normal, d[k]);
	return true;
}

bool gaze_ellipse(struct ellipse *e, const struct gaze_globe *globe, const struct gaze_view *view,
                  const double fick[2])
{
	double p[16][2], R[3][3];
	gaze_rotation(R, (double[3]){ fick[0], fick[1], 0 });
	for (int i = 0; i < 16; i++) {
		double angle = 2 * M_PI * i / 16, eye[3] = { globe->limbus * cos(angle), globe->limbus * sin(angle),
		                                             gaze_plane(globe) };
		if (!gaze_pixel_of(p[i], globe, view, R, eye))
			return false;
	}
	return ellipse_fit_direct(e, 16, p, 0);
}
