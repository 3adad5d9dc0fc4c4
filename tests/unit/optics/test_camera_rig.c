/* rig.json: what is written is read again; what no camera can be is refused. */
#include "base/file.h"
#include "base/mem.h"
#include "optics/camera_rig.h"
#include "tests/lib/scratch.h"
#include "tests/lib/unit.h"

static const struct camera lens = { .center_px = { 400.25, 299.5 }, .distortion = { -0.1, 0.02, 1e-3, -2e-3, 0.001 } };

static struct camera_rig make(void)
{
	struct camera_rig rig = { .cameras = mem_new(2, sizeof *rig.cameras), .n = 2, .scale_sigma = 0.0125, .scale_source = "limbus",
		                      .frame_source = "eyes and mouth" };
	rig.cameras[0] = (struct rig_camera){ mem_str("a"), mem_str("views/a b.jpg"), -1, 800, 600, lens, { 900.5, 901 }, true,
		{ { 0, -1, 0, 12.5 }, { 1, 0, 0, -7 }, { 0, 0, 1, 600 }, { 0, 0, 0, 1 } }, 0.41, 123 };
	rig.cameras[1] = (struct rig_camera){ mem_str("v"), mem_str("video/v.mp4"), 120, 1920, 1080, lens, { 1500, 1500 }, false,
		{ { 0 } }, NAN, 0 };
	rig.has_eyes = true;
	for (int i = 0; i < 6; i++)
		rig.eye_center[i / 3][i % 3] = 31.25 - 11.5 * i;
	return rig;
}

static void test_round_trip(void **state)
{
	(void)state;
	struct camera_rig made = make(), read;
	struct err err = { 0 };
	const char *path = scratch_path("rig.json");
	assert_true(camera_rig_save(&made, path, "{\"stage\":\"calibrate\"}", "{\"not_registered\":[]}", &err));
	if (!camera_rig_load(&read, path, &err))
		fail_msg("%s", err.msg);
	assert_int_equal(read.n, 2);
	const struct rig_camera *c = camera_rig_find(&read, "views/a b.jpg"), *v = camera_rig_find(&read, "video/v.mp4");
	assert_non_null(c);
	assert_non_null(v);
	assert_null(camera_rig_find(&read, "a"));
	assert_string_equal(c->name, "a");
	assert_int_equal(c->width, 800);
	assert_int_equal(c->points, 123);
	assert_int_equal(c->camera.source, CAMERA_RIG);
	// 12 digits are written.
	NEAR(c->camera.focal_px, sqrt(900.5 * 901), 1e-8);
	NEAR(c->cam_from_head[0][1], -1, 0);
	NEAR(c->cam_from_head[2][3], 600, 0);
	for (int i = 0; i < 5; i++)
		NEAR(c->camera.distortion[i], lens.distortion[i], 1e-12);
	assert_true(c->has_pose && !v->has_pose);
	assert_true(isnan(v->residual_px));
	NEAR(read.scale_sigma, 0.0125, 1e-12);
	assert_true(c->frame == -1 && v->frame == 120);
	assert_true(read.has_eyes);
	for (int i = 0; i < 6; i++)
		NEAR(read.eye_center[i / 3][i % 3], made.eye_center[i / 3][i % 3], 1e-10);
	assert_string_equal(read.scale_source, "limbus");
	camera_rig_free(&made);
	camera_rig_free(&read);
}

#define HEAD "{\"scale_source\":\"limbus\",\"scale_sigma\":0.1,\"frame_source\":\"cameras\",\"cameras\":"
#define CAMERA(w, fx, k1, pose) "[{\"name\":\"a\",\"file\":\"views/a\",\"width\":" w ",\"height\":6,\"fx\":" fx ",\"fy\":5,\"cx\":4,\"cy\":3," \
	"\"distortion\":[" k1 ",0,0,0,0],\"cam_from_head\":" pose ",\"residual_px\":null,\"points\":3}]}"
#define POSE "[1,0,0,0,0,1,0,0,0,0,1,9,0,0,0,1]"

static void test_refused(void **state)
{
	(void)state;
	static const struct {
		const char *text, *says;
	} bad[] = {
		{ HEAD CAMERA("8", "5", "0", POSE), 0 },
		{ HEAD CAMERA("8", "5", "0", "null"), 0 },
		{ HEAD "[]}", 0 },
		{ "[]", "must be a JSON object" },
		{ "{}", "scale_source" },
		{ HEAD "7}", "cameras: must be an array" },
		{ HEAD "[{}]}", "name: must be" },
		{ HEAD CAMERA("0", "5", "0", POSE), "out of range" },
		{ HEAD CAMERA("8", "-5", "0", POSE), "out of range" },
		{ HEAD CAMERA("8", "null", "0", POSE), "out of range" },
		{ HEAD CAMERA("8", "5", "1e7", POSE), "out of range" },
		{ HEAD CAMERA("8", "5", "0", "[1,0,0]"), "cam_from_head" },
		{ HEAD CAMERA("8", "5", "0", "[1,0,0,0,0,1,0,0,0,0,-1,9,0,0,0,1]"), "must be a rotation" },
		{ HEAD CAMERA("8", "5", "0", "[2,0,0,0,0,2,0,0,0,0,2,9,0,0,0,1]"), "must be a rotation" },
		{ HEAD CAMERA("8", "5", "0", "[1,0,0,0,0,1,0,0,0,0,1,1e12,0,0,0,1]"), "must be a rotation" },
	};
	for (int i = 0; i < COUNT(bad); i++) {
		struct camera_rig rig;
		struct err err = { 0 };
		bool ok = camera_rig_load(&rig, scratch_text("bad.json", bad[i].text), &err);
		if (ok != !bad[i].says)
			fail_msg("case %d: %s", i, err.msg);
		if (bad[i].says) {
			ERR_HAS(err, bad[i].says);
			assert_null(rig.cameras);
		}
		camera_rig_free(&rig);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = { cmocka_unit_test(test_round_trip), cmocka_unit_test(test_refused) };
	return cmocka_run_group_tests(tests, scratch_setup, scratch_teardown);
}
