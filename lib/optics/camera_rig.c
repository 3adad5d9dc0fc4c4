#include "optics/camera_rig.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/json.h"
#include "base/mem.h"

enum { RIG_FILE_LIMIT = 64 << 20, RIG_CAMERAS = 100000 };

static json_t *camera_json(const struct rig_camera *c)
{
	json_t *j = json_object();
	json_object_set_new(j, "name", json_string(c->name));
	json_object_set_new(j, "file", json_string(c->file));
	if (c->frame >= 0)
		json_object_set_new(j, "frame", json_integer(c->frame));
	json_object_set_new(j, "width", json_integer(c->width));
	json_object_set_new(j, "height", json_integer(c->height));
	json_object_set_new(j, "fx", json_number(c->focal[0]));
	json_object_set_new(j, "fy", json_number(c->focal[1]));
	json_object_set_new(j, "cx", json_number(c->camera.center_px[0]));
	json_object_set_new(j, "cy", json_number(c->camera.center_px[1]));
	json_object_set_new(j, "distortion", json_numbers(5, c->camera.distortion));
	json_object_set_new(j, "cam_from_head", c->has_pose ? json_numbers(16, &c->cam_from_head[0][0]) : json_null());
	json_object_set_new(j, "residual_px", json_number(c->residual_px));
	json_object_set_new(j, "points", json_integer(c->points));
	return j;
}

bool camera_rig_save(const struct camera_rig *rig, const char *path, const char *made_by, const char *extra, struct err *err)
{
	json_t *json = json_object(), *cameras = json_array();
	for (int i = 0; i < rig->n; i++)
		json_array_append_new(cameras, camera_json(&rig->cameras[i]));
	json_object_set_new(json, "unit", json_string("mm"));
	json_object_set_new(json, "scale_source", json_string(rig->scale_source));
	json_object_set_new(json, "scale_sigma", json_number(rig->scale_sigma));
	json_object_set_new(json, "frame_source", json_string(rig->frame_source));
	json_object_set_new(json, "cameras", cameras);
	json_object_set_new(json, "eye_center", rig->has_eyes ? json_numbers(6, &rig->eye_center[0][0]) : json_null());
	if (extra) {
		json_t *more = json_loads(extra, 0, 0);
		json_object_update_missing(json, more);
		json_decref(more);
	}
	bool ok = json_write(path, json, made_by, err);
	json_decref(json);
	return ok;
}

static bool rigid(const double m[4][4])
{
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++) {
			double dot = m[i][0] * m[j][0] + m[i][1] * m[j][1] + m[i][2] * m[j][2];
			if (!(fabs(dot - (i == j)) < 1e-6))
				return false;
		}
	double det = m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0])
	             + m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
	bool last = !m[3][0] && !m[3][1] && !m[3][2] && m[3][3] == 1;
	return det > 0 && last && fabs(m[0][3]) + fabs(m[1][3]) + fabs(m[2][3]) < 1e9;
}

static bool camera_check(struct rig_camera *c, double w, double h, double points, const char *path, struct err *err)
{
	bool size = w >= 1 && w <= 1e6 && h >= 1 && h <= 1e6;
	bool lens = c->focal[0] > 0 && c->focal[1] > 0 && c->focal[0] < 1e9 && c->focal[1] < 1e9
	            && fabs(c->camera.center_px[0]) < 1e7 && fabs(c->camera.center_px[1]) < 1e7;
	for (int i = 0; i < 5; i++)
		lens &= fabs(c->camera.distortion[i]) < 1e6;
	if (!size || !lens)
		return err_set(err, "%s: cameras: %s: size, focal length, centre or distortion out of range", path, c->name);
	if (c->has_pose && !rigid(c->cam_from_head))
		return err_set(err, "%s: cameras: %s: cam_from_head must be a rotation and a translation", path, c->name);
	c->width = (int)w;
	c->height = (int)h;
	c->points = points > 0 && points < 1e9 ? (int)points : 0;
	c->camera.focal_px = sqrt(c->focal[0] * c->focal[1]);
	c->camera.source = CAMERA_RIG;
	return true;
}

static bool camera_read(struct rig_camera *c, const json_t *j, const char *path, struct err *err)
{
	double w, h, points;
	const char *name = json_get_string(j, "name", path, err), *file = json_get_string(j, "file", path, err);
	*c = (struct rig_camera){ 0 };
	if (!name || !file)
		return false;
	c->name = mem_str(name);
	c->file = mem_str(file);
	const json_t *frame = json_object_get(j, "frame");
	c->frame = json_is_integer(frame) && json_integer_value(frame) >= 0 ? (long)json_integer_value(frame) : -1;
	c->has_pose = json_is_array(json_object_get(j, "cam_from_head"));
	return json_get(&w, j, "width", path, err) && json_get(&h, j, "height", path, err)
	       && json_get(&c->focal[0], j, "fx", path, err) && json_get(&c->focal[1], j, "fy", path, err)
	       && json_get(&c->camera.center_px[0], j, "cx", path, err) && json_get(&c->camera.center_px[1], j, "cy", path, err)
	       && json_get_array(c->camera.distortion, 5, j, "distortion", path, err)
	       && (!c->has_pose || json_get_array(&c->cam_from_head[0][0], 16, j, "cam_from_head", path, err))
	       && json_get(&c->residual_px, j, "residual_px", path, err) && json_get(&points, j, "points", path, err)
	       && camera_check(c, w, h, points, path, err);
}

static bool rig_read(struct camera_rig *rig, const json_t *json, const char *path, struct err *err)
{
	const json_t *cameras = json_object_get(json, "cameras");
	const char *scale = json_get_string(json, "scale_source", path, err),
	           *frame = json_get_string(json, "frame_source", path, err);
	if (!scale || !frame || !json_get(&rig->scale_sigma, json, "scale_sigma", path, err))
		return false;
	strncpy(rig->scale_source, scale, sizeof rig->scale_source - 1);
	strncpy(rig->frame_source, frame, sizeof rig->frame_source - 1);
	rig->has_eyes = json_is_array(json_object_get(json, "eye_center"));
	if (rig->has_eyes && !json_get_array(&rig->eye_center[0][0], 6, json, "eye_center", path, err))
		return false;
	size_t n = json_array_size(cameras);
	if (!json_is_array(cameras) || n > RIG_CAMERAS)
		return err_set(err, "%s: cameras: must be an array of at most %d", path, RIG_CAMERAS);
	rig->cameras = mem_new(n, sizeof *rig->cameras);
	for (size_t i = 0; i < n; i++) {
		rig->n++;
		if (!camera_read(&rig->cameras[i], json_array_get(cameras, i), path, err))
			return false;
	}
	return true;
}

bool camera_rig_load(struct camera_rig *rig, const char *path, struct err *err)
{
	*rig = (struct camera_rig){ 0 };
	json_t *json = json_read(path, RIG_FILE_LIMIT, err);
	if (!json)
		return false;
	bool ok = rig_read(rig, json, path, err);
	json_decref(json);
	if (!ok)
		camera_rig_free(rig);
	return ok;
}

const struct rig_camera *camera_rig_find(const struct camera_rig *rig, const char *file)
{
	for (int i = 0; i < rig->n; i++)
		if (!strcmp(rig->cameras[i].file, file))
			return &rig->cameras[i];
	return 0;
}

void camera_rig_free(struct camera_rig *rig)
{
	for (int i = 0; i < rig->n; i++) {
		free(rig->cameras[i].name);
		free(rig->cameras[i].file);
	}
	free(rig->cameras);
	*rig = (struct camera_rig){ 0 };
}
