/* Videos: what is written is read again; hostile and damaged files. Truth: the pictures that went in; the file's own bytes,
 * changed in known places. */
#include <sys/stat.h>

#include "base/file.h"
#include "base/mem.h"
#include "image/video/video.h"
#include "math/rng.h"
#include "tests/lib/scratch.h"
#include "tests/lib/unit.h"

enum { W = 160, H = 96, FRAMES = 24 };
static const struct video_conf conf = { 10, 1000, 2, 0 };

/* A smooth picture that drifts. */
static void paint(uint8_t *rgb, int w, int h, int frame)
{
	for (int y = 0; y < h; y++)
		for (int x = 0; x < w; x++) {
			double u = (x + 0.7 * frame) / 17, v = y / 11.0;
			uint8_t *p = rgb + 3 * ((long)y * w + x);
			p[0] = (uint8_t)(128 + 90 * sin(u) * cos(v));
			p[1] = (uint8_t)(120 + 80 * sin(u + 0.3));
			p[2] = (uint8_t)(100 + 60 * cos(v));
		}
}

static double even(int i)
{
	return i / 30.0;
}

static double uneven(int i)
{
	return i / 30.0 + (i > 9 ? 0.1 : 0) + (i % 3 == 2 ? 0.013 : 0);
}

static const char *write_video(const char *name, int w, int h, double (*time)(int))
{
	static char path[512];
	struct err err = { 0 };
	struct video_writer_conf how = { .width = w, .height = h, .fps = 30, .crf = 8, .made_by = "test" };
	uint8_t *rgb = mem_array((size_t)w * (size_t)h, 3);
	snprintf(path, sizeof path, "%s", scratch_path("%s", name));
	struct video_writer *writer = video_writer_open(path, &how, &err);
	assert_non_null(writer);
	for (int i = 0; i < FRAMES; i++) {
		paint(rgb, w, h, i);
		assert_true(video_writer_put(writer, rgb, time(i), &err));
	}
	assert_true(video_writer_close(writer, true, &err));
	free(rgb);
	return path;
}

/* Reads all frames; mean difference of their colours from what went in, rotated back. */
static double differences(const char *path, struct video_info *info, double (*time)(int), long *n)
{
	struct err err = { 0 };
	struct video_frame frame;
	bool got = true;
	double sum = 0;
	uint8_t *rgb = mem_array(W * H, 3), *want = mem_array(W * H, 3);
	struct video *video = video_open(info, path, &conf, &err);
	if (!video)
		fail_msg("%s", err.msg);
	for (*n = 0; video_next(&frame, &got, video, &err) && got; (*n)++) {
		NEAR(frame.time, time((int)*n), 1e-4);
		assert_int_equal(frame.index, *n);
		video_frame_rgb(rgb, 3 * info->width, &frame, 0, 0, info->width, info->height);
		paint(want, W, H, (int)*n);
		for (int y = 0; y < H; y++)
			for (int x = 0; x < W; x++) {
				int r = info->rotation;
				int u = r == 90 ? H - 1 - y : r == 180 ? W - 1 - x : r == 270 ? y : x;
				int v = r == 90 ? x : r == 180 ? H - 1 - y : r == 270 ? W - 1 - x : y;
				for (int c = 0; c < 3; c++)
					sum += abs(rgb[3 * ((long)v * info->width + u) + c] - want[3 * ((long)y * W + x) + c]);
			}
		video_frame_free(&frame);
	}
	assert_false(err_is(&err));
	video_close(video);
	free(rgb);
	free(want);
	return sum / (double)(*n * W * H * 3);
}

static void round_trip(void **state)
{
	(void)state;
	struct video_info info;
	long n;
	const char *path = write_video("a.mp4", W, H, even);
	double d = differences(path, &info, even, &n);
	assert_int_equal(n, FRAMES);
	assert_int_equal(info.frames, FRAMES);
	assert_int_equal(info.width, W);
	NEAR(info.fps, 30, 0.02);
	assert_false(info.variable);
	// half the resolution of colour and quantisation at quality 8
	NEAR(d, 0, 3);
	struct err err = { 0 };
	assert_true(video_header(&info, path, &err));
	assert_int_equal(info.promised, FRAMES);
	NEAR(info.fps, 30, 0.02);
	assert_false(video_header(&info, scratch_text("text.mp4", "no film"), &err));
	assert_int_equal(info.promised, 0);
}

/* More than one group of pictures: an encoder's key frames are 250 apart. */
static void read_from_its_start(void **state)
{
	(void)state;
	enum { LONG = 270, SMALL = 64 };
	struct err err = { 0 };
	struct video_info info;
	struct video_frame frame;
	struct video_writer_conf how = { .width = SMALL, .height = SMALL, .fps = 30, .crf = 20 };
	uint8_t *rgb = mem_array(SMALL * SMALL, 3);
	struct video_writer *writer = video_writer_open(scratch_path("long.mp4"), &how, &err);
	for (int i = 0; i < LONG; i++) {
		memset(rgb, 40 + i / 2, SMALL * SMALL * 3);
		assert_true(video_writer_put(writer, rgb, even(i), &err));
	}
	assert_true(video_writer_close(writer, true, &err));
	struct video *video = video_open(&info, scratch_path("long.mp4"), &conf, &err);
	bool got = true;
	int n = 0;
	for (; video_next(&frame, &got, video, &err) && got; n++) {
		NEAR(frame.time, even(n), 1e-3);
		video_frame_rgb(rgb, 3 * SMALL, &frame, 0, 0, SMALL, SMALL);
		NEAR(rgb[3 * (SMALL * SMALL / 2)], 40 + n / 2, 6);  // of 256, after quantisation
		video_frame_free(&frame);
	}
	assert_int_equal(n, LONG);
	video_close(video);
	free(rgb);
}

static void same_bytes(void **state)
{
	(void)state;
	char a[33], b[33];
	struct err err = { 0 };
	assert_true(file_hash(a, write_video("a.mp4", W, H, even), 1 << 30, &err));
	assert_true(file_hash(b, write_video("b.mp4", W, H, even), 1 << 30, &err));
	assert_string_equal(a, b);
}

static void odd_sides(void **state)
{
	(void)state;
	struct video_info info;
	struct err err = { 0 };
	const char *path = write_video("odd.mp4", 101, 67, even);
	struct video *video = video_open(&info, path, &conf, &err);
	assert_non_null(video);
	assert_int_equal(info.width, 102);
	assert_int_equal(info.height, 68);
	struct video_frame frame;
	uint8_t whole[3 * 102 * 68], part[3 * 102 * 68];
	bool got;
	assert_true(video_next(&frame, &got, video, &err) && got);
	video_frame_rgb(whole, 3 * info.width, &frame, 0, 0, info.width, info.height);
	// a part has the bytes of the whole, wherever it begins and ends between two pixels that share their colour
	for (int x0 = 0; x0 < 4; x0++)
		for (int x1 = info.width - 3; x1 <= info.width; x1++) {
			memset(part, 1, sizeof part);
			video_frame_rgb(part, 3 * info.width, &frame, x0, 3, x1, info.height - 2);
			for (int y = 0; y < info.height; y++)
				for (int x = 0; x < info.width; x++) {
					const bool in = x >= x0 && x < x1 && y >= 3 && y < info.height - 2;
					for (int c = 0; c < 3; c++)
						assert_int_equal(part[3 * (y * info.width + x) + c], in ? whole[3 * (y * info.width + x) + c] : 1);
				}
		}
	video_frame_free(&frame);
	video_close(video);  // with frames still ahead
}

static void variable_rate(void **state)
{
	(void)state;
	struct video_info info;
	long n;
	differences(write_video("v.mp4", W, H, uneven), &info, uneven, &n);
	assert_int_equal(n, FRAMES);
	assert_true(info.variable);
}

/* The first place of that name in a file's bytes. */
static char *box(char *data, size_t size, const char *name)
{
	char *p = memmem(data, size, name, 4);
	assert_non_null(p);
	return p;
}

/* A turn by 90 degrees clockwise as ISO 14496-12 writes it into the track's header: a b u c d v x y w. */
static void rotation_tag(void **state)
{
	(void)state;
	static const int turns[4][4] = { { 1, 0, 0, 1 }, { 0, 1, -1, 0 }, { -1, 0, 0, -1 }, { 0, -1, 1, 0 } };
	struct err err = { 0 };
	for (int r = 1; r < 4; r++) {
		char *data, path[512];
		size_t size;
		assert_true(file_read(&data, &size, write_video("r.mp4", W, H, even), 1 << 24, &err));
		uint8_t *matrix = (uint8_t *)box(data, size, "tkhd") + 4 + 40;
		const int at[] = { 0, 1, 3, 4 };
		for (int k = 0; k < 4; k++) {
			uint32_t v = (uint32_t)(turns[r][k] * 65536);
			for (int b = 0; b < 4; b++)
				matrix[4 * at[k] + b] = (uint8_t)(v >> (24 - 8 * b));
		}
		snprintf(path, sizeof path, "%s", scratch_write("turned.mp4", data, size));
		free(data);
		struct video_info info;
		long n;
		double d = differences(path, &info, even, &n);
		assert_int_equal(info.rotation, 90 * r);
		assert_int_equal(info.width, r == 2 ? W : H);
		NEAR(d, 0, 3);
	}
}

static void broken_files(void **state)
{
	(void)state;
	struct err err = { 0 };
	struct video_info info;
	char *data;
	size_t size;
	assert_true(file_read(&data, &size, write_video("w.mp4", W, H, even), 1 << 24, &err));
	// the index comes first: what is cut off are pictures
	const char *path = scratch_write("cut.mp4", data, size * 2 / 3);
	struct video *video = video_open(&info, path, &conf, &err);
	assert_non_null(video);
	assert_true(info.promised == FRAMES && info.frames < FRAMES && info.frames > 0);
	struct video_frame frame;
	bool got = true;
	long n = 0;
	for (; video_next(&frame, &got, video, &err) && got; n++)
		video_frame_free(&frame);
	assert_true(n > 0 && n <= info.frames);
	video_close(video);
	// the index itself cut off
	assert_null(video_open(&info, scratch_write("head.mp4", data, 100), &conf, &err));
	ERR_HAS(err, "cut off");
	// the same file, its only track called sound
	err = (struct err){ 0 };
	memcpy(box(data, size, "vide"), "soun", 4);
	assert_null(video_open(&info, scratch_write("sound.mp4", data, size), &conf, &err));
	ERR_HAS(err, "no picture");
	free(data);
	// a playlist must not lead anywhere
	err = (struct err){ 0 };
	char *list = mem_printf("#EXTM3U\n#EXTINF:1,\nfile://%s\n", path);
	assert_null(video_open(&info, scratch_text("list.m3u8", list), &conf, &err));
	free(list);
	err = (struct err){ 0 };
	assert_null(video_open(&info, scratch_path("nothing.mp4"), &conf, &err));
	ERR_HAS(err, "No such file");
	err = (struct err){ 0 };
	assert_int_equal(mkfifo(scratch_path("pipe.mp4"), 0600), 0);  // nobody writes to it
	assert_null(video_open(&info, scratch_path("pipe.mp4"), &conf, &err));
	ERR_HAS(err, "is not a regular file");
}

static void limits(void **state)
{
	(void)state;
	struct err err = { 0 };
	struct video_info info;
	const char *path = write_video("l.mp4", W, H, even);
	assert_null(video_open(&info, path, &(struct video_conf){ 0.01, 1000, 1, 0 }, &err));
	ERR_HAS(err, "limit.video_mpx");
	err = (struct err){ 0 };
	assert_null(video_open(&info, path, &(struct video_conf){ 10, 5, 1, 0 }, &err));
	ERR_HAS(err, "limit.video_frames");
	err = (struct err){ 0 };
	assert_null(video_open(&info, path, &(struct video_conf){ 10, 1000, 1, 0.01 }, &err));
	ERR_HAS(err, "limit.video_s");
}

/* Bytes changed at random: an error or frames, never a crash. */
static void noise_in_files(void **state)
{
	(void)state;
	struct err err = { 0 };
	char *data;
	size_t size;
	struct rng rng = { 5 };
	assert_true(file_read(&data, &size, write_video("n.mp4", W, H, even), 1 << 24, &err));
	char *copy = mem_array(size, 1);
	for (int trial = 0; trial < 60; trial++) {
		memcpy(copy, data, size);
		for (int k = 0; k < 1 + trial / 4; k++)
			copy[rng_below(&rng, trial % 2 ? 1200 : (int)size)] = (char)rng_bits(&rng);
		struct video_info info;
		err = (struct err){ 0 };
		struct video *video = video_open(&info, scratch_write("noise.mp4", copy, size), &conf, &err);
		struct video_frame frame;
		bool got = true;
		while (video && video_next(&frame, &got, video, &err) && got) {
			assert_true(frame.width == info.width && frame.height == info.height);
			video_frame_free(&frame);
		}
		assert_true(video || err_is(&err));
		video_close(video);
	}
	free(copy);
	free(data);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(round_trip),   cmocka_unit_test(read_from_its_start), cmocka_unit_test(same_bytes),   cmocka_unit_test(odd_sides),
		cmocka_unit_test(variable_rate), cmocka_unit_test(rotation_tag), cmocka_unit_test(broken_files),
		cmocka_unit_test(limits),       cmocka_unit_test(noise_in_files),
	};
	return cmocka_run_group_tests(tests, scratch_setup, scratch_teardown);
}
