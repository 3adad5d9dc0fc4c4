/* Cameras before a portrait, and the rays of their pixels. */
#include <math.h>

#include "draw/face/impl.h"
#include "math/vec.h"

struct portrait_view portrait_front(const struct rig *rig, int side, double field, double yaw, double pitch, int width, int height)
{
	// A long lens, as portraits are taken.
	double distance = 900, cy = cos(yaw), sy = sin(yaw), cp = cos(pitch), sp = sin(pitch), aim[3], t[3];
	struct portrait_view v = { .width = width, .height = height, .center_px = { width / 2.0, height / 2.0 }, .focal_px = distance * width / field };
	double turn[3][3] = { { cy, 0, -sy }, { sp * sy, cp, sp * cy }, { cp * sy, -sp, cp * cy } };
	double cam_from_head[3][3] = { { 1, 0, 0 }, { 0, -1, 0 }, { 0, 0, -1 } }, m[3][3];
	mat_mul(m, turn, cam_from_head);
	mat_mul(m, m, rig->head_from_target);
	for (int c = 0; c < 3; c++)
		aim[c] = side < 0 ? 0.5 * (rig->globe[0].center[c] + rig->globe[1].center[c]) : rig->globe[side].center[c];
	mat_vec(t, (const double(*)[3])m, aim);
	for (int i = 0; i < 3; i++) {
		for (int j = 0; j < 3; j++)
			v.cam_from_target[i][j] = m[i][j];
		v.cam_from_target[i][3] = (i == 2 ? distance : 0) - t[i];
	}
	return v;
}

struct portrait_rays portrait_rays_of(const struct portrait_view *view)
{
	struct portrait_rays r = { .view = view };
	double scale2 = 0;
	for (int k = 0; k < 3; k++)
		scale2 += view->cam_from_target[0][k] * view->cam_from_target[0][k];
	for (int i = 0; i < 3; i++) {
		double o = 0;
		for (int k = 0; k < 3; k++) {
			r.rig_from_cam[i][k] = view->cam_from_target[k][i] / sqrt(scale2);
			o -= view->cam_from_target[k][i] * view->cam_from_target[k][3] / scale2;
		}
		r.origin[i] = (float)o;
	}
	return r;
}

float portrait_ray(float dir[3], const struct portrait_rays *r, double x, double y)
{
	const struct portrait_view *v = r->view;
	double cam[3] = { (x - v->center_px[0]) / v->focal_px, (y - v->center_px[1]) / v->focal_px, 1 }, d[3], len = vec_norm(cam);
	mat_vec(d, r->rig_from_cam, cam);
	for (int c = 0; c < 3; c++)
		dir[c] = (float)(d[c] / len);
	// The camera's own scale: depth is measured in its frame.
	double scale = sqrt(v->cam_from_target[0][0] * v->cam_from_target[0][0] + v->cam_from_target[0][1] * v->cam_from_target[0][1]
	                    + v->cam_from_target[0][2] * v->cam_from_target[0][2]);
	return (float)(scale / len);
}
