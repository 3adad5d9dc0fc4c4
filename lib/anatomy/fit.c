#include "anatomy/fit.h"

#include <math.h>
#include <string.h>

#include "base/json.h"
#include "base/mem.h"
#include "math/vec.h"

enum { FIT_FILE_LIMIT = 1 << 20 };
static const double deg = M_PI / 180;
static const char *const source_names[] = { "weak perspective", "capture.conf", "EXIF", "rig" };

static json_t *ellipse_json(const struct ellipse *e)
{
	return json_pack("{s:f,s:f,s:f,s:f,s:f}", "cx", e->cx, "cy", e->cy, "a", e->a, "b", e->b, "angle_deg",
	                 e->angle / deg);
}

// Of a picture: no side of a photograph has as many px.
static const double px_most = 1e5;

/* Whether numbers that anybody may have written can be reckoned with; NAN: not known. */
static bool bounded(int n, const double *x, double most)
{
	for (int i = 0; i < n; i++)
		if (fabs(x[i]) > most)
			return false;
	return true;
}

static bool ellipse_read(struct ellipse *e, const json_t *json, const char *path, struct err *err)
{
	if (!json_get(&e->cx, json, "cx", path, err) || !json_get(&e->cy, json, "cy", path, err)
	    || !json_get(&e->a, json, "a", path, err) || !json_get(&e->b, json, "b", path, err)
	    || !json_get(&e->angle, json, "angle_deg", path, err))
		return false;
	e->angle *= deg;
	if (!(e->a >= e->b && e->b > 0) || !isfinite(e->cx + e->cy + e->a + e->angle) || !bounded(1, &e->cx, px_most) || !bounded(1, &e->cy, px_most) || e->a > px_most
	    || fabs(e->angle) > 100)
		return err_set(err, "%s: ellipse: must be within %g px, with a >= b > 0", path, px_most);
	return true;
}

static json_t *camera_json(const struct fit *fit)
{
	const struct camera *c = &fit->camera;
	json_t *json = json_object();
	json_object_set_new(json, "source", json_string(source_names[c->source]));
	json_object_set_new(json, "focal_px", json_number(c->focal_px));
	json_object_set_new(json, "center_px", json_numbers(2, c->center_px));
	json_object_set_new(json, "distortion", json_numbers(5, c->distortion));
	json_object_set_new(json, "width", json_integer(fit->width));
	json_object_set_new(json, "height", json_integer(fit->height));
	return json;
}

bool fit_save(const struct fit *fit, const char *path, const char *made_by, const char *extra, struct err *err)
{
	json_t *json = json_object();
	json_object_set_new(json, "status", json_string(!fit->ok ? "rejected" : fit->rough > 0 ? "rough" : "ok"));
	json_object_set_new(json, "reason", json_string(fit->reason));
	if (fit->ok && fit->rough > 0)
		json_object_set_new(json, "known_to", json_number(fit->rough));
	if (fit->ok) {
		json_object_set_new(json, "ellipse", ellipse_json(&fit->limbus));
		json_t *sigma = json_object();
		static const char *const names[] = { "cx", "cy", "a", "b", "angle_deg" };
		for (int i = 0; i < 5; i++)
			json_object_set_new(sigma, names[i], json_number(fit->ellipse_sigma[i] / (i == 4 ? deg : 1)));
		json_object_set_new(json, "ellipse_sigma", sigma);
		json_object_set_new(json, "pupil", fit->has_pupil ? ellipse_json(&fit->pupil) : json_null());
		json_object_set_new(json, "theta_deg", json_number(fit->theta / deg));
		json_object_set_new(json, "phi_deg", json_number(fit->phi / deg));
		json_object_set_new(json, "theta_sigma_deg", json_number(fit->theta_sigma / deg));
		json_object_set_new(json, "cam_from_eye", json_numbers(16, &fit->cam_from_eye[0][0]));
		json_object_set_new(json, "coverage", json_number(fit->coverage));
		json_object_set_new(json, "limbus_seen", json_numbers(FIT_SECTORS, fit->seen));
		json_object_set_new(json, "rms_px", json_number(fit->rms_px));
		json_object_set_new(json, "edge_sigma_px", json_number(fit->edge_sigma_px));
		json_object_set_new(json, "limbus_aspect", json_number(fit->limbus_aspect));
		json_object_set_new(json, "limbus_aspect_sigma", json_number(fit->limbus_aspect_sigma));
		json_object_set_new(json, "projection",
		                    json_string(fit->camera.source == CAMERA_NONE ? "weak perspective" : "perspective"));
		json_object_set_new(json, "camera", camera_json(fit));
	}
	if (extra) {
		json_t *more = json_loads(extra, 0, 0);
		json_object_update_missing(json, more);
		json_decref(more);
	}
	bool ok = json_write(path, json, made_by, err);
	json_decref(json);
	return ok;
}

static bool camera_read(struct fit *fit, const json_t *json, const char *path, struct err *err)
{
	struct camera *c = &fit->camera;
	double width, height;
	const char *source = json_get_string(json, "source", path, err);
	if (!source || !json_get(&c->focal_px, json, "focal_px", path, err)
	    || !json_get_array(c->center_px, 2, json, "center_px", path, err)
	    || !json_get_array(c->distortion, 5, json, "distortion", path, err)
	    || !json_get(&width, json, "width", path, err) || !json_get(&height, json, "height", path, err))
		return false;
	for (int i = 0; i < COUNT(source_names); i++)
		if (!strcmp(source, source_names[i]))
			c->source = (enum camera_source)i;
	if (!(width >= 1 && width <= px_most && height >= 1 && height <= px_most && c->focal_px > 0 && c->focal_px <= 1e9)
	    || !bounded(2, c->center_px, 10 * px_most) || !bounded(5, c->distortion, 1e6))
		return err_set(err, "%s: camera: width, height in [1, %g] px, focal_px in (0, 1e9], center_px, distortion of a picture's size", path, px_most);
	fit->width = (int)width;
	fit->height = (int)height;
	return true;
}

static bool fit_read(struct fit *fit, const json_t *json, const char *path, struct err *err)
{
	const char *status = json_get_string(json, "status", path, err), *reason = json_get_string(json, "reason", path, err);
	if (!status || !reason)
		return false;
	strncpy(fit->reason, reason, sizeof fit->reason - 1);
	const bool rough = !strcmp(status, "rough");
	fit->ok = rough || !strcmp(status, "ok");
	if (!fit->ok)
		return true;
	if (rough && (!json_get(&fit->rough, json, "known_to", path, err) || !(fit->rough > 0 && fit->rough < 1)))
		return err_set(err, "%s: known_to: must be a share of the semi-axis, in (0, 1)", path);
	const json_t *pupil = json_object_get(json, "pupil"), *sigma = json_object_get(json, "ellipse_sigma");
	static const char *const names[] = { "cx", "cy", "a", "b", "angle_deg" };
	for (int i = 0; i < 5; i++) {
		if (!json_get(&fit->ellipse_sigma[i], sigma, names[i], path, err))
			return false;
		fit->ellipse_sigma[i] *= i == 4 ? deg : 1;
	}
	fit->has_pupil = json_is_object(pupil);
	for (int i = 0; i < FIT_SECTORS; i++)
		fit->seen[i] = 1;
	if (json_object_get(json, "limbus_seen") && !json_get_array(fit->seen, FIT_SECTORS, json, "limbus_seen", path, err))
		return false;
	bool ok = ellipse_read(&fit->limbus, json_object_get(json, "ellipse"), path, err)
	          && (!fit->has_pupil || ellipse_read(&fit->pupil, pupil, path, err))
	          && json_get(&fit->theta, json, "theta_deg", path, err) && json_get(&fit->phi, json, "phi_deg", path, err)
	          && json_get(&fit->theta_sigma, json, "theta_sigma_deg", path, err)
	          && json_get_array(&fit->cam_from_eye[0][0], 16, json, "cam_from_eye", path, err)
	          && json_get(&fit->coverage, json, "coverage", path, err) && json_get(&fit->rms_px, json, "rms_px", path, err)
	          && json_get(&fit->edge_sigma_px, json, "edge_sigma_px", path, err)
	          && json_get(&fit->limbus_aspect, json, "limbus_aspect", path, err)
	          && json_get(&fit->limbus_aspect_sigma, json, "limbus_aspect_sigma", path, err)
	          && camera_read(fit, json_object_get(json, "camera"), path, err);
	const double few[] = { fit->theta, fit->phi, fit->coverage, fit->limbus_aspect, fit->limbus_aspect_sigma }, many[] = { fit->rms_px, fit->edge_sigma_px, fit->theta_sigma };
	if (ok && (!bounded(COUNT(few), few, 1000) || !bounded(COUNT(many), many, 1e9) || !bounded(16, &fit->cam_from_eye[0][0], 1e9)))
		ok = err_set(err, "%s: angles, cam_from_eye, coverage or residuals: no photograph of an eye has such", path);
	if (ok && (fit->limbus.cx < -fit->width || fit->limbus.cx > 2.0 * fit->width || fit->limbus.cy < -fit->height || fit->limbus.cy > 2.0 * fit->height))
		ok = err_set(err, "%s: ellipse: its centre, %g %g, must lie within one picture's size of the picture, %d x %d px", path, fit->limbus.cx, fit->limbus.cy, fit->width,
		             fit->height);
	if (ok && fit->has_pupil && fit->pupil.a >= fit->limbus.a)
		ok = err_set(err, "%s: pupil: a = %g px, must be less than the limbus' %g", path, fit->pupil.a, fit->limbus.a);
	fit->theta *= deg;
	fit->phi *= deg;
	fit->theta_sigma *= deg;
	return ok;
}

bool fit_load(struct fit *fit, const char *path, struct err *err)
{
	*fit = (struct fit){ 0 };
	json_t *json = json_read(path, FIT_FILE_LIMIT, err);
	if (!json)
		return false;
	bool ok = fit_read(fit, json, path, err);
	json_decref(json);
	return ok;
}

/* v_eye = Rᵀ v_cam */
static void rotate_into_eye(double out[3], const struct fit *fit, const double v[3])
{
	double t[3];
	for (int i = 0; i < 3; i++)
		t[i] = fit->cam_from_eye[0][i] * v[0] + fit->cam_from_eye[1][i] * v[1] + fit->cam_from_eye[2][i] * v[2];
	memcpy(out, t, sizeof t);
}

void fit_camera_in_eye(double center[3], const struct fit *fit)
{
	double t[3] = { -fit->cam_from_eye[0][3], -fit->cam_from_eye[1][3], -fit->cam_from_eye[2][3] };
	rotate_into_eye(center, fit, t);
}

void fit_ray(double origin[3], double dir[3], const struct fit *fit, const double px[2])
{
	double d[3];
	camera_ray(d, &fit->camera, px);
	rotate_into_eye(dir, fit, d);
	fit_camera_in_eye(origin, fit);
}

bool fit_project(double px[2], const struct fit *fit, const double P[3])
{
	double c[3];
	for (int i = 0; i < 3; i++)
		c[i] = vec_dot(fit->cam_from_eye[i], P) + fit->cam_from_eye[i][3];
	return camera_project(px, &fit->camera, c);
}
