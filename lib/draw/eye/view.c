#include "draw/eye/view.h"

#include <math.h>
#include <string.h>

#include "math/vec.h"

struct scene_view scene_view_turned(const struct scene *scene, double yaw, double pitch, double field, int size)
{
	// A long lens, 500 mm from the middle of the eye that shows: a little in front of its centre of rotation. There `field` fills the picture.
	double distance = 500, front = 0.1 * scene->conf.sclera_radius, cy = cos(yaw), sy = sin(yaw), cp = cos(pitch), sp = sin(pitch);
	double turn[3][3] = { { cy, 0, -sy }, { sp * sy, cp, sp * cy }, { cp * sy, -sp, cp * cy } };
	double t[3];
	struct scene_view v = { .scale = 1, .width = size, .height = size, .samples = 1 };
	double focal = distance * size / field;
	v.camera = (struct camera){ .focal_px = focal, .center_px = { size / 2.0, size / 2.0 }, .source = CAMERA_CONF };
	mat_vec(t, turn, (double[3]){ 0, 0, scene->sclera_z });
	for (int i = 0; i < 3; i++) {
		for (int j = 0; j < 3; j++)
			v.cam_from_eye[i][j] = turn[i][j];
		v.cam_from_eye[i][3] = (i == 2 ? distance + front : 0) - t[i];
	}
	v.cam_from_eye[3][3] = 1;
	return v;
}

struct scene_view scene_view_photo(const struct fit *fit, const double window[4], double scale)
{
	struct scene_view v = { .camera = fit->camera, .x0 = window[0], .y0 = window[1], .scale = scale, .samples = 1 };
	memcpy(v.cam_from_eye, fit->cam_from_eye, sizeof v.cam_from_eye);
	v.width = (int)lrint((window[2] - window[0]) / scale);
	v.height = (int)lrint((window[3] - window[1]) / scale);
	return v;
}
