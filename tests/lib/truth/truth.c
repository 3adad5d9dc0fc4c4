#include "tests/lib/truth/truth.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/json.h"
#include "base/mem.h"
#include "math/vec.h"
#include "tests/lib/bench/bench.h"

static const double deg = M_PI / 180;

static bool ellipse_load(struct ellipse *e, const json_t *json, const char *path, struct err *err)
{
	bool ok = json_get(&e->cx, json, "cx", path, err) && json_get(&e->cy, json, "cy", path, err)
	          && json_get(&e->a, json, "a", path, err) && json_get(&e->b, json, "b", path, err)
	          && json_get(&e->angle, json, "angle_deg", path, err);
	e->angle *= deg;
	return ok;
}

static bool eye_load(struct truth *t, const json_t *json, const char *path, struct err *err)
{
	t->eye.two_surface = json_is_true(json_object_get(json, "two_surface"));
	t->eye.limbus_aspect = 1;
	return json_get(&t->eye.cornea_radius, json, "R", path, err)
	       && json_get(&t->eye.cornea_asphericity, json, "p", path, err)
	       && json_get(&t->eye.index, json, t->eye.two_surface ? "n_aqueous" : "n", path, err)
	       && json_get(&t->eye.limbus_radius, json, "r_limbus", path, err)
	       && json_get(&t->eye.iris_depth, json, "iris_z", path, err)
	       && json_get(&t->eye.post_radius, json, "R_post", path, err)
	       && json_get(&t->eye.post_asphericity, json, "p_post", path, err)
	       && json_get(&t->eye.thickness, json, "cct", path, err)
	       && json_get(&t->eye.cornea_index, json, "n_cornea", path, err)
	       && json_get(&t->iris_radius, json, "iris_r", path, err)
	       && json_get(&t->pupil_radius, json, "pupil_r", path, err);
}

/* The camera's pose in the rendered eye's frame, turned into the product's (lib/README.md). */
static bool pose_load(struct truth *t, const json_t *camera, const char *path, struct err *err)
{
	const json_t *frame = json_object_get(camera, "eye_frame"), *rows = json_object_get(frame, "R"),
	             *K = json_object_get(camera, "K");
	double R[3][3], tr[3];
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++)
			R[i][j] = json_number_value(json_array_get(json_array_get(rows, (size_t)i), (size_t)j));
	for (int i = 0; i < 2; i++)
		t->center_px[i] = json_number_value(json_array_get(json_array_get(K, (size_t)i), 2));
	if (!json_get_array(tr, 3, frame, "t", path, err) || !json_get(&t->focal_px, camera, "f_px", path, err))
		return false;
	double z[3] = { 0, 0, 1 }, axis[3] = { R[0][2], R[1][2], R[2][2] }, smallest[3][3];
	mat_smallest_rotation(smallest, z, axis);
	double x_truth[3] = { R[0][0], R[1][0], R[2][0] }, x[3];
	mat_tvec(x, smallest, x_truth);
	t->turn = atan2(x[1], x[0]);
	for (int i = 0; i < 3; i++) {
		for (int j = 0; j < 3; j++)
			t->cam_from_eye[i][j] = smallest[i][j];
		t->cam_from_eye[i][3] = tr[i];
	}
	t->cam_from_eye[3][3] = 1;
	return true;
}

bool truth_load(struct truth *t, const char *dir, struct err *err)
{
	*t = (struct truth){ 0 };
	const char *slash = strrchr(dir, '/');
	snprintf(t->name, sizeof t->name, "%s", slash ? slash + 1 : dir);
	snprintf(t->photo, sizeof t->photo, "%s/photo.jpg", dir);
	char *path = mem_printf("%s/truth.json", dir);
	json_t *json = json_read(path, 1 << 22, err);
	const json_t *view = json_object_get(json, "view"), *flat = json_object_get(json, "truth2d");
	bool ok = json && eye_load(t, json_object_get(json, "eye"), path, err)
	          && pose_load(t, json_object_get(json, "camera"), path, err)
	          && json_get(&t->theta, view, "theta_deg", path, err) && json_get(&t->phi, view, "phi_deg", path, err)
	          && json_get(&t->covered, json_object_get(json, "limbus_status"), "covered_fraction_lid_and_lash", path, err)
	          && ellipse_load(&t->limbus, json_object_get(flat, "limbus_ellipse_exact"), path, err)
	          && ellipse_load(&t->pupil, json_object_get(flat, "pupil_ellipse_refracted"), path, err);
	t->theta *= deg;
	t->phi *= deg;
	json_decref(json);
	free(path);
	return ok;
}

int truth_captures(char *dirs[], int max)
{
	const char *root = bench_data("eyes");
	struct file_list list = { 0 };
	struct err err = { 0 };
	int n = 0;
	if (!root || !file_list(&list, root, &err))
		return 0;
	for (int i = 0; i < list.n && n < max; i++) {
		char *truth = mem_printf("%s/%s/truth.json", root, list.names[i]);
		if (file_exists(truth))
			dirs[n++] = mem_printf("%s/%s", root, list.names[i]);
		free(truth);
	}
	file_list_free(&list);
	return n;
}

struct fit truth_fit(const struct truth *t)
{
	struct fit fit = { .ok = true, .limbus = t->limbus, .pupil = t->pupil, .has_pupil = true, .theta = t->theta,
		               .phi = t->phi, .coverage = 1 - t->covered, .width = 1600, .height = 1200,
		               .limbus_aspect = 1, .edge_sigma_px = 1 };
	memcpy(fit.cam_from_eye, t->cam_from_eye, sizeof fit.cam_from_eye);
	fit.camera = (struct camera){ .focal_px = t->focal_px, .center_px = { t->center_px[0], t->center_px[1] },
		                          .source = CAMERA_CONF };
	return fit;
}

void truth_turn(double out[2], const struct truth *t, const double in[2])
{
	double c = cos(t->turn), s = sin(t->turn), x = c * in[0] - s * in[1];
	out[1] = s * in[0] + c * in[1];
	out[0] = x;
}

bool truth_make_capture(const struct truth *t, const char *dest, const char *extra, struct err *err)
{
	char *data, *photo = mem_printf("%s/photos/%s.jpg", dest, t->name), *conf = mem_printf("%s/capture.conf", dest);
	size_t size;
	const struct eye *e = &t->eye;
	bool ok = file_read(&data, &size, t->photo, 1 << 26, err) && file_write(photo, data, size, err);
	free(data);
	char *text = mem_printf("camera.focal_px = %.6f\ncamera.center_px = %.3f %.3f\neye.cornea_radius_mm = %.6f\n"
	                        "eye.cornea_asphericity = %.6f\neye.index = %.6f\neye.limbus_radius_mm = %.6f\n"
	                        "eye.limbus_aspect = 1\neye.iris_depth_mm = %.6f\neye.two_surface = %s\n"
	                        "eye.posterior_radius_mm = %.6f\neye.posterior_asphericity = %.6f\n"
	                        "eye.cornea_thickness_mm = %.6f\neye.cornea_index = %.6f\n%s",
	                        t->focal_px, t->center_px[0], t->center_px[1], e->cornea_radius, e->cornea_asphericity,
	                        e->index, e->limbus_radius, e->iris_depth, e->two_surface ? "yes" : "no", e->post_radius,
	                        e->post_asphericity, e->thickness, e->cornea_index, extra ? extra : "");
	ok = ok && file_write(conf, text, strlen(text), err);
	free(text);
	free(photo);
	free(conf);
	return ok;
}
