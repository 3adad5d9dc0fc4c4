/* fit: what limbus writes can be read back; rays and projections agree with each other and with the truth. */
#include "base/file.h"
#include "anatomy/fit.h"
#include "math/vec.h"
#include "tests/lib/scratch.h"
#include "tests/lib/truth/truth.h"
#include "tests/lib/unit.h"

static struct fit sample(void)
{
	struct fit fit = { .ok = true, .limbus = { 800, 600, 500, 450, 0.3 }, .has_pupil = true,
		               .pupil = { 801, 602, 180, 170, 0.2 }, .theta = 0.4, .phi = 1.1, .theta_sigma = 0.01,
		               .coverage = 0.8, .rms_px = 0.3, .edge_sigma_px = 2, .limbus_aspect = 0.95,
		               .limbus_aspect_sigma = 0.02, .width = 1600, .height = 1200 };
	double z[3] = { 0, 0, 1 }, axis[3] = { 0.3, -0.2, sqrt(1 - 0.13) }, R[3][3];
	mat_smallest_rotation(R, z, axis);
	for (int i = 0; i < 3; i++)
		memcpy(fit.cam_from_eye[i], R[i], sizeof R[i]);
	fit.cam_from_eye[0][3] = 1;
	fit.cam_from_eye[1][3] = -2;
	fit.cam_from_eye[2][3] = 120;
	fit.cam_from_eye[3][3] = 1;
	fit.camera = (struct camera){ 10000, { 800, 600 }, { -0.1, 0.02, 1e-3, -2e-3, 0.01 }, CAMERA_CONF };
	return fit;
}

static void what_is_written_is_read(void **state)
{
	(void)state;
	const char *path = scratch_path("fit.json");
	struct fit fit = sample(), back;
	struct err err = { 0 };
	assert_true(fit_save(&fit, path, "{\"stage\":\"limbus\"}", "{\"more\":1}", &err));
	assert_true(fit_load(&back, path, &err));
	assert_float_equal(back.limbus.angle, fit.limbus.angle, 1e-9);
	assert_float_equal(back.pupil.a, fit.pupil.a, 1e-8);
	assert_float_equal(back.theta_sigma, fit.theta_sigma, 1e-11);
	assert_float_equal(back.cam_from_eye[1][3], -2, 1e-11);
	assert_int_equal(back.camera.source, CAMERA_CONF);
	assert_float_equal(back.camera.distortion[3], -2e-3, 1e-12);
}

/* One that is known roughly is as usable, and says so; to nothing, or to all of it, none is. */
static void a_rough_one_says_so(void **state)
{
	(void)state;
	const char *path = scratch_path("fit.json");
	struct fit fit = sample(), back;
	struct err err = { 0 };
	char *text = 0;
	size_t size = 0;
	fit.rough = 0.03;
	strcpy(fit.reason, "soft");
	assert_true(fit_save(&fit, path, "{\"stage\":\"limbus\"}", 0, &err));
	assert_true(file_read(&text, &size, path, 1 << 20, &err));
	assert_non_null(strstr(text, "\"status\": \"rough\""));
	assert_true(fit_load(&back, path, &err));
	assert_true(back.ok && back.rough == 0.03 && !strcmp(back.reason, "soft"));
	free(text);
	fit.rough = 1;
	assert_true(fit_save(&fit, path, "{\"stage\":\"limbus\"}", 0, &err));
	assert_false(fit_load(&back, path, &err));
	assert_non_null(strstr(err.msg, "known_to"));
}

static void damaged_files_are_refused(void **state)
{
	(void)state;
	static const char *const texts[] = { "", "[]", "{", "{\"status\": \"ok\"}", "{\"status\": 1, \"reason\": \"\"}",
		"{\"status\": \"ok\", \"reason\": \"\", \"ellipse\": {\"cx\": null}}" };
	const char *path = scratch_path("fit.json");
	for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
		struct err err = { 0 };
		struct fit fit;
		assert_true(file_write(path, texts[i], strlen(texts[i]), &err));
		assert_false(fit_load(&fit, path, &err));
		assert_non_null(strstr(err.msg, path));
	}
}

/* A pupil larger than the iris: the file, the value, the rule. */
static void large_pupil_is_refused(void **state)
{
	(void)state;
	const char *path = scratch_path("fit.json");
	struct fit fit = sample(), back;
	struct err err = { 0 };
	fit.pupil.a = 520;
	assert_true(fit_save(&fit, path, "{\"stage\":\"limbus\"}", "{\"more\":1}", &err));
	assert_false(fit_load(&back, path, &err));
	assert_non_null(strstr(err.msg, path));
	assert_non_null(strstr(err.msg, "pupil: a = 520 px, must be less than the limbus' 500"));
}

/* A ray through a pixel must project back to it at any distance: distortion and its inverse cancel. */
static void rays_project_back(void **state)
{
	(void)state;
	struct fit fit = sample();
	for (int i = 0; i < 400; i++) {
		double px[2] = { 4.0 * i, 3.0 * (399 - i) }, o[3], d[3], P[3], back[2];
		fit_ray(o, d, &fit, px);
		vec_add(P, o, 117, d);
		assert_true(fit_project(back, &fit, P));
		assert_float_equal(back[0], px[0], 1e-7);
		assert_float_equal(back[1], px[1], 1e-7);
	}
}

/* The truth's pose, in our frame, projects the limbus circle onto the truth's ellipse. */
static void truth_pose_gives_truth_ellipse(void **state)
{
	(void)state;
	char *dirs[64];
	int n = truth_captures(dirs, 64);
	if (!n)
		skip();
	for (int i = 0; i < n; i++) {
		struct truth t;
		struct err err = { 0 };
		assert_true(truth_load(&t, dirs[i], &err));
		struct fit fit = truth_fit(&t);
		double worst = 0, z = eye_limbus_depth(&t.eye);
		for (int k = 0; k < 360; k++) {
			double a = k * M_PI / 180, P[3] = { t.eye.limbus_radius * cos(a), t.eye.limbus_radius * sin(a), z }, px[2];
			assert_true(fit_project(px, &fit, P));
			const struct ellipse *e = &t.limbus;
			double x = px[0] - e->cx, y = px[1] - e->cy, c = cos(e->angle), s = sin(e->angle);
			double u = (c * x + s * y) / e->a, v = (c * y - s * x) / e->b;
			worst = fmax(worst, fabs(hypot(u, v) - 1) * e->a);
		}
		assert_true(worst < 1e-3);  // px; the truth's numbers are rounded to about 1e-13 of the image
		free(dirs[i]);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		SCRATCH_TEST(what_is_written_is_read),
		SCRATCH_TEST(a_rough_one_says_so),
		SCRATCH_TEST(damaged_files_are_refused),
		SCRATCH_TEST(large_pupil_is_refused),
		cmocka_unit_test(rays_project_back),
		cmocka_unit_test(truth_pose_gives_truth_ellipse),
	};
	return cmocka_run_group_tests(tests, 0, 0);
}
