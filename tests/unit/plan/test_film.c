/* Whether the camera of a video moved, told from films that are drawn here: noise that stands, that stands but for its middle, and that shifts. */
#include "tests/lib/unit.h"

#include <sys/stat.h>

#include "base/file.h"
#include "base/mem.h"
#include "image/video/video.h"
#include "math/rng.h"
#include "plan/film.h"
#include "tests/lib/scratch.h"

enum { WIDE = 480, HIGH = 320, FRAMES = 60, BLOB = 12 };

/* Noise in squares of BLOB px. */
static int noise(int x, int y)
{
	struct rng rng = { 1 + (uint64_t)(x / BLOB + 4096) * 8192 + (uint64_t)(y / BLOB + 4096) };
	return (int)rng_range(&rng, 20, 235);
}

/* aside: px a frame that all is shifted by; within: only in the middle. plain: no texture at the border. */
static void film(const char *dir, int aside, bool within, bool plain)
{
	struct err err = { 0 };
	char *folder = mem_printf("%s/video", scratch_path("%s", dir));
	assert_true(file_mkdirs(folder, &err));
	char *path = mem_printf("%s/a.mp4", folder);
	struct video_writer_conf conf = { .width = WIDE, .height = HIGH, .fps = 30, .crf = 18, .preset = "ultrafast" };
	struct video_writer *writer = video_writer_open(path, &conf, &err);
	assert_non_null(writer);
	uint8_t *rgb = mem_array(3 * WIDE * HIGH, 1);
	for (int f = 0; f < FRAMES; f++) {
		for (int y = 0; y < HIGH; y++)
			for (int x = 0; x < WIDE; x++) {
				bool middle = x > WIDE / 4 && x < 3 * WIDE / 4 && y > HIGH / 4 && y < 3 * HIGH / 4;
				int value = plain && !middle ? 128 : noise(x + (within && !middle ? 0 : aside * f), y);
				for (int c = 0; c < 3; c++)
					rgb[3 * (y * WIDE + x) + c] = (uint8_t)value;
			}
		assert_true(video_writer_put(writer, rgb, f / 30.0, &err));
	}
	assert_true(video_writer_close(writer, true, &err));
	free(rgb);
	free(path);
	free(folder);
}

static enum film_camera camera_of(const char *dir)
{
	char *capture = mem_str(scratch_path("%s", dir));
	enum film_camera is = plan_film_camera(capture, "video/a.mp4");
	assert_int_equal(plan_film_camera(capture, "video/a.mp4"), is);  // the second time from what was kept
	free(capture);
	return is;
}

static void test_camera(void **state)
{
	(void)state;
	film("rests", 0, false, false);
	film("face", 3, true, false);
	film("moves", 3, false, false);
	film("plain", 3, true, true);
	assert_int_equal(camera_of("rests"), FILM_RESTS);
	assert_int_equal(camera_of("face"), FILM_RESTS);
	assert_int_equal(camera_of("moves"), FILM_MOVES);
	assert_int_equal(camera_of("plain"), FILM_RESTS);  // a person who moves before a wall: nothing tells that it is the camera
}

/* Frames of the whole and of its first minute; a file in its place is looked at anew, one that is gone is none. */
static void test_length(void **state)
{
	(void)state;
	struct err err = { 0 };
	film("length", 0, false, false);
	char *capture = mem_str(scratch_path("length")), *path = mem_printf("%s/video/a.mp4", capture);
	for (int again = 0; again < 2; again++) {
		const struct film_length is = plan_film_length(capture, "video/a.mp4");
		NEAR(is.frames, FRAMES, 1e-9);
		NEAR(is.minute, FRAMES, 1e-9);
	}
	uint8_t *rgb = mem_new(3 * 64 * 48, 1);
	struct video_writer_conf conf = { .width = 64, .height = 48, .fps = 2, .crf = 30, .preset = "ultrafast" };
	struct video_writer *writer = video_writer_open(path, &conf, &err);
	for (int f = 0; f < 200; f++)
		assert_true(video_writer_put(writer, rgb, f / 2.0, &err));
	assert_true(video_writer_close(writer, true, &err));
	const struct film_length slow = plan_film_length(capture, "video/a.mp4");
	NEAR(slow.frames, 200, 1e-9);
	NEAR(slow.minute, 120, 1.5);
	assert_int_equal(remove(path), 0);
	assert_true(plan_film_length(capture, "video/a.mp4").frames == 0);
	free(rgb);
	free(capture);
	free(path);
}

/* What is no film, and a pipe that nobody writes to: not known, and it does not wait. */
static void test_no_film(void **state)
{
	(void)state;
	struct err err = { 0 };
	char *path = mem_str(scratch_path("none/video"));
	assert_true(file_mkdirs(path, &err));
	char *fifo = mem_printf("%s/a.mp4", path);
	assert_int_equal(mkfifo(fifo, 0600), 0);
	assert_int_equal(camera_of("none"), FILM_UNKNOWN);
	assert_int_equal(remove(fifo), 0);
	assert_true(file_write(fifo, "text", 4, &err));
	assert_int_equal(camera_of("none"), FILM_UNKNOWN);
	free(fifo);
	free(path);
}

int main(void)
{
	const struct CMUnitTest tests[] = { cmocka_unit_test(test_camera), cmocka_unit_test(test_length), cmocka_unit_test(test_no_film) };
	scratch_open();
	int failed = cmocka_run_group_tests(tests, 0, 0);
	scratch_close();
	return failed;
}
