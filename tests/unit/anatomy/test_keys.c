/* Keys that several programs read: the focal length they give, and names that are not there. */
#include "tests/lib/unit.h"

#include "anatomy/keys.h"
#include "base/file.h"
#include "base/mem.h"
#include "image/video/video.h"
#include "tests/lib/scratch.h"
#include "track/clip/clip.h"

static int setup(void **state)
{
	(void)state;
	scratch_open();
	return 0;
}

static int teardown(void **state)
{
	(void)state;
	scratch_close();
	return 0;
}

/* A full-frame sensor, 36 mm x 24 mm, behind 50 mm: 36 mm of it are the 1920 px, whichever way the camera was held. */
static void test_focal(void **state)
{
	(void)state;
	struct camera_keys k = { .focal_px = NAN, .focal_mm = 50, .sensor_mm = 36 };
	assert_true(fabs(camera_keys_focal(&k, 1920, 1280) - 50.0 / 36 * 1920) < 1e-9);
	assert_true(camera_keys_focal(&k, 1920, 1280) == camera_keys_focal(&k, 1280, 1920));
	k.focal_px = 1234;
	assert_true(camera_keys_focal(&k, 1920, 1280) == 1234);
	k = (struct camera_keys){ .focal_px = NAN, .focal_mm = 50, .sensor_mm = NAN };
	assert_true(isnan(camera_keys_focal(&k, 1920, 1280)));
}

/* 50 mm on 36 mm make 2667 px of 1920; an iris of 5.85 mm that is 400 px wide stands f * 5.85 / 400 before the camera. */
static void test_pairs(void **state)
{
	(void)state;
	struct err err = { 0 };
	struct camera_keys k = { .focal_px = 2700, .focal_mm = 50, .sensor_mm = 36 };
	assert_true(camera_keys_agree(&k, 1920, 1280, &err));
	k.focal_px = 11826;
	assert_false(camera_keys_agree(&k, 1920, 1280, &err));
	ERR_HAS(err, "camera.focal_px = 11826, and camera.focal_mm = 50 with camera.sensor_mm = 36, which make it 2666.67 px");
	k.sensor_mm = NAN;
	err = (struct err){ 0 };
	assert_true(camera_keys_agree(&k, 1920, 1280, &err));
	assert_true(camera_keys_place(684, 5.85, 400, &err));  // 10.004 mm
	assert_true(camera_keys_place(6.83e6, 5.85, 400, &err));
	assert_false(camera_keys_place(300, 5.85, 400, &err));
	ERR_HAS(err, "camera.focal_px = 300 with eye.limbus_radius_mm = 5.85: an iris of 400 px stands 4.39 mm before");
	assert_false(camera_keys_place(1e7, 5.85, 400, &err));
}

/* Focal length with which a grey clip of that size is opened; no face is in it, so that opening ends there. */
static double focal_of_clip(int width, int height)
{
	struct err err = { 0 };
	struct video_writer_conf conf = { .width = width, .height = height, .fps = 25, .crf = 30 };
	struct video_writer *writer = video_writer_open(scratch_path("c/video/clip.mp4"), &conf, &err);
	uint8_t *rgb = mem_new((size_t)width * (size_t)height, 3);
	memset(rgb, 128, 3 * (size_t)width * (size_t)height);
	for (int i = 0; i < 5; i++)
		assert_true(video_writer_put(writer, rgb, i / 25.0, &err));
	free(rgb);
	assert_true(video_writer_close(writer, true, &err));
	struct stage stage = { .capture = scratch_path("c"), .name = "track", .quiet = true, .threads = 1 };
	struct track_conf track = { .video = { .limit_mpx = 10, .limit_frames = 100, .threads = 1 },
		                    .camera = { .focal_px = NAN, .focal_mm = 50, .sensor_mm = 36, .center_px = { NAN, NAN } },
		                    .reference = 1, .search = 3, .distance_mm = 600 };
	struct track_subject subject = { 0 };
	struct track_clip clip = { .file = "video/clip.mp4" };
	track_clip_open(&clip, &stage, &subject, &track, &err);
	double focal = clip.camera.focal_px;
	track_clip_free(&clip);
	for (int i = 0; i < stage.n_strings; i++)
		free(stage.strings[i]);
	free(stage.strings);
	return focal;
}

static void test_clip_held_either_way(void **state)
{
	(void)state;
	double landscape = focal_of_clip(320, 192), portrait = focal_of_clip(192, 320);
	assert_true(fabs(landscape - 50.0 / 36 * 320) < 1e-9);
	assert_true(landscape == portrait);
}

static void test_camera(void **state)
{
	(void)state;
	static const struct {
		struct camera c;
		const char *says;
	} cases[] = {
		{ { 2000, { 800, 600 }, { 0 }, CAMERA_CONF }, "" },
		{ { 2000, { 800, 600 }, { -0.3, 0.1, 0.001, 0, 0 }, CAMERA_CONF }, "" },   // a wide lens as they are
		{ { 11000, { -300, 1500 }, { 0.2, 0, 0, 0, 0 }, CAMERA_CONF }, "" },       // cut out beside the axis
		{ { NAN, { 800, 600 }, { 100, 0, 0, 0, 0 }, CAMERA_NONE }, "" },           // parallel projection: no distortion
		{ { 2000, { 1e6, -1e6 }, { 0 }, CAMERA_CONF }, "camera.center_px = 1e+06 -1e+06: must lie within one picture's size" },
		{ { 2000, { NAN, 600 }, { 0 }, CAMERA_CONF }, "camera.center_px" },
		// r (1 - r^2 / 3) turns round at r = 1, where it is 2/3: the corner, 0.707 from the middle, is beyond.
		{ { 1414.2, { 800, 600 }, { -1.0 / 3, 0, 0, 0, 0 }, CAMERA_CONF }, "folds the picture" },
		{ { 1600, { 800, 600 }, { -1.0 / 3, 0, 0, 0, 0 }, CAMERA_CONF }, "" },     // the corner at 0.625 is not
		{ { 2000, { 800, 600 }, { -100, 0, 0, 0, 0 }, CAMERA_CONF }, "folds the picture" },
		{ { 2000, { 800, 600 }, { NAN, 0, 0, 0, 0 }, CAMERA_CONF }, "folds the picture" },
		// r (1 + 20 r^2) is 0.12 at r = 0.1, 1.2 times as far; r (1 + 100 r^2) is 0.2 there, twice.
		{ { 8333.3, { 800, 600 }, { 20, 0, 0, 0, 0 }, CAMERA_CONF }, "" },
		{ { 5000, { 800, 600 }, { 100, 0, 0, 0, 0 }, CAMERA_CONF }, "the corners stand 2 times as far" },
	};
	for (int i = 0; i < COUNT(cases); i++) {
		struct err err = { 0 };
		bool ok = camera_keys_check(&cases[i].c, 1600, 1200, &err);
		if (ok != !*cases[i].says || !strstr(err.msg, cases[i].says))
			fail_msg("case %d: %s", i, err.msg);
	}
}

/* What the check says of one line of capture.conf, or "" where it is content. */
static const char *said(const char *line)
{
	static struct err err;
	struct conf conf = { 0 };
	err = (struct err){ 0 };
	assert_true(conf_load(&conf, scratch_text("d/capture.conf", line), "", 1, &err));
	bool ok = keys_check_names(&conf, scratch_path("d"), &err);
	assert_int_equal(ok, !err_is(&err));
	conf_free(&conf);
	return err.msg;
}

static void test_names(void **state)
{
	(void)state;
	static const char *const files[] = { "d/photos/left_a.jpg", "d/photos/right.b.png", "d/views/v1.jpg", "d/video/clip.mp4", "d/targets/made.ply" };
	for (int i = 0; i < COUNT(files); i++)
		scratch_text(files[i], "");
	static const char *const good[] = { "", "photo.left_a.hint_px = 1 2 3\n", "photo.right.b.eye = right\n", "view.v1.ruler_px = 0 0 1 1\n",
		                            "view.left_a.distance_mm = 500\n", "view.clip_12.mouth_px = 1 2 3 4\n", "target.made.unit_mm = 10\n",
		                            "limbus.edge_sigma = 2\n" };
	for (int i = 0; i < COUNT(good); i++)
		if (*said(good[i]))
			fail_msg("%s: %s", good[i], said(good[i]));
	static const struct {
		const char *line, *end;
	} bad[] = {
		{ "photo.nobody.hint_px = 1 2 3\n", "capture.conf:1: photo.nobody.hint_px: no photograph is called nobody: there are left_a, right.b" },
		{ "photo.left_a.jpg.eye = left\n", "capture.conf:1: photo.left_a.jpg.eye: no photograph is called left_a.jpg: there are left_a, right.b" },
		{ "\nview.v2.ruler_px = 0 0 1 1\n", "capture.conf:2: view.v2.ruler_px: no view is called v2: there are v1, left_a, right.b, clip_FRAME" },
		{ "view.clip_.mouth_px = 1 2 3 4\n", "no view is called clip_: there are v1, left_a, right.b, clip_FRAME" },
		{ "view.clip_1x.mouth_px = 1 2 3 4\n", "no view is called clip_1x: there are v1, left_a, right.b, clip_FRAME" },
		{ "target.male.unit_mm = 10\n", "no character is called male: there are made" },
	};
	for (int i = 0; i < COUNT(bad); i++) {
		const char *got = said(bad[i].line);
		size_t n = strlen(got), m = strlen(bad[i].end);
		if (n < m || strcmp(got + n - m, bad[i].end))
			fail_msg("%s: \"%s\"", bad[i].line, got);
	}
	// Of many names a dozen are listed.
	for (int i = 0; i < 40; i++)
		{
			char name[32];
			snprintf(name, sizeof name, "d/targets/t%02d.obj", i);
			scratch_text(name, "");
		}
	assert_non_null(strstr(said("target.male.unit_mm = 10\n"), "t00, t01"));
	assert_non_null(strstr(said("target.male.unit_mm = 10\n"), " and 29 more"));
	// A folder that is not there has no names.
	assert_true(!file_exists(scratch_path("d/nothing")));
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_focal),
		cmocka_unit_test(test_pairs),
		cmocka_unit_test(test_clip_held_either_way),
		cmocka_unit_test(test_camera),
		cmocka_unit_test(test_names),
	};
	return cmocka_run_group_tests(tests, setup, teardown);
}
