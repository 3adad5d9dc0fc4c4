/* Images: colour by the standard's own numbers, EXR round trips, hostile EXR files. */
#include "tests/lib/unit.h"

#include <omp.h>

#include "base/file.h"
#include "base/mem.h"
#include "image/exr.h"
#include "image/plane.h"
#include "tests/lib/scratch.h"
#include "tests/peers/exr_channels.h"

enum { W = 61, H = 37, LIMIT = 1 << 20 };

static const char *const rgbw[] = { "R", "G", "B", "W" };

/* IEC 61966-2-1. */
static void srgb_by_the_standard(void **state)
{
	(void)state;
	NEAR(linear_from_srgb(0.5f), 0.21404114048223255, 1e-7);
	NEAR(linear_from_srgb(0.04045f), 0.04045 / 12.92, 1e-9);
	NEAR(srgb_from_linear(0.18f), 0.46135612950044164, 1e-7);
	NEAR(srgb_from_linear(0), 0, 0);
	NEAR(srgb_from_linear(1), 1, 1e-6);
	for (int i = 0; i <= 1000; i++)  // float's 6e-8, times the steepest slope 12.92
		NEAR(srgb_from_linear(linear_from_srgb((float)i / 1000)), i / 1000.0, 1e-6);
}

static void bytes_are_the_nearest(void **state)
{
	(void)state;
	struct image image = image_new(256, 4, 1);
	for (int i = 0; i < 256; i++)
		image.px[i] = linear_from_srgb((float)i / 255);
	float odd[] = { -1, 2, NAN, INFINITY, -INFINITY };
	memcpy(image.px + 256, odd, sizeof odd);
	uint8_t *px = image_to_srgb8(&image);
	for (int i = 0; i < 256; i++)
		assert_int_equal(px[i], i);
	assert_true(px[256] == 0 && px[257] == 255 && px[258] == 0 && px[259] == 255 && px[260] == 0);
	free(px);
	image_free(&image);
}

static void sampling_is_bilinear(void **state)
{
	(void)state;
	struct image image = image_new(W, H, 2);
	for (int y = 0; y < H; y++)
		for (int x = 0; x < W; x++) {  // a plane is reproduced exactly, in the coordinates of pixel centres
			image_at(&image, x, y)[0] = (float)(x + 0.5);
			image_at(&image, x, y)[1] = (float)(2 * (y + 0.5) - 3 * (x + 0.5));
		}
	NEAR(image_sample(&image, 10.5, 7.5, 0), 10.5, 0);
	NEAR(image_sample(&image, 10.75, 7.25, 0), 10.75, 1e-5);
	NEAR(image_sample(&image, 10.75, 7.25, 1), 2 * 7.25 - 3 * 10.75, 1e-4);
	NEAR(image_sample(&image, -100, 7.5, 0), 0.5, 0);
	NEAR(image_sample(&image, 1e6, 7.5, 0), W - 0.5, 0);
	image_free(&image);
}

static struct image sample(int channels)
{
	struct image image = image_new(W, H, channels);
	for (int i = 0; i < W * H * channels; i++)
		image.px[i] = (float)sin(i) * powf(10, (float)(i % 5) - 3);
	image.px[1] = NAN;
	image.px[2] = 0;
	image.px[3] = -INFINITY;
	return image;
}

static void exr_round_trip(void **state)
{
	(void)state;
	const char *path = scratch_path("a.exr");
	struct err err = { 0 };
	for (int type = EXR_HALF; type <= EXR_FLOAT; type++)
		for (int channels = 1; channels <= 4; channels++) {
			struct image image = sample(channels), back;
			struct exr_info info = { 6.4, "{\"stage\":\"t\u00e9st\"}" }, got = { 0 };
			if (!exr_write(path, &image, rgbw, type, &info, &err) || !exr_read(&back, path, channels, rgbw, LIMIT, &got, &err))
				fail_msg("%s", err.msg);
			assert_true(back.width == W && back.height == H && back.channels == channels);
			NEAR(got.extent_mm, 6.4, 1e-6);  // a float attribute
			for (int i = 0; i < W * H * channels; i++)
				if (!isfinite(image.px[i]))
					assert_true(isnan(image.px[i]) ? isnan(back.px[i]) : back.px[i] == image.px[i]);
				else  // a half has 11 bits; below 6e-5 its steps are 6e-8
					NEAR(back.px[i], image.px[i], type == EXR_FLOAT ? 0 : fabsf(image.px[i]) / 2048 + 6e-8f);
			image_free(&image);
			image_free(&back);
		}
}

static void channels_by_name(void **state)
{
	(void)state;
	static const char *const in[] = { "Y", "T" }, *const out[] = { "T" }, *const none[] = { "Q" };
	const char *path = scratch_path("a.exr");
	struct image image = sample(2), back;
	struct err err = { 0 };
	char *names;
	assert_true(exr_write(path, &image, in, EXR_FLOAT, 0, &err) && exr_read(&back, path, 1, out, LIMIT, 0, &err));
	for (int i = 4; i < W * H; i++)
		assert_true(back.px[i] == image.px[2 * i + 1]);
	image_free(&back);
	assert_true(exr_channels(&names, path, &err));
	assert_string_equal(names, "T,Y");
	free(names);
	assert_false(exr_read(&back, path, 1, none, LIMIT, 0, &err));
	ERR_HAS(err, "Q");
	ERR_HAS(err, "a.exr");
	assert_null(back.px);
	image_free(&image);
}

/* The order in which every picture of ours has them, which one of OpenEXRCore's fast paths for half turns round. */
static void red_stays_red(void **state)
{
	(void)state;
	static const char *const rgba[] = { "R", "G", "B", "A" };
	const char *path = scratch_path("a.exr");
	struct image image = image_new(W, H, 4), back;
	struct err err = { 0 };
	for (int i = 0; i < 4 * W * H; i++)
		image.px[i] = (float)(i % 1024);  // exact in half
	for (int type = EXR_HALF; type <= EXR_FLOAT; type++) {
		assert_true(exr_write(path, &image, rgba, type, 0, &err) && exr_read(&back, path, 4, rgba, LIMIT, 0, &err));
		assert_memory_equal(back.px, image.px, 4 * W * H * sizeof(float));
		image_free(&back);
	}
	image_free(&image);
}

/* Every choice of channels out of one to four: what is left out must not confuse the decoder. */
static void any_subset_of_channels(void **state)
{
	(void)state;
	struct err err = { 0 };
	const char *path = scratch_path("a.exr");
	for (int type = EXR_HALF; type <= EXR_FLOAT; type++)
		for (int channels = 1; channels <= 4; channels++) {
			struct image image = image_new(W, H, channels), back;
			for (int i = 0; i < W * H * channels; i++)
				image.px[i] = (float)(i % 1024);  // exact in half
			assert_true(exr_write(path, &image, rgbw, type, 0, &err));
			for (int mask = 1; mask < 1 << channels; mask++) {
				const char *names[4];
				int of[4], n = 0;
				for (int c = 0; c < channels; c++)
					if (mask >> c & 1) {
						of[n] = c;
						names[n++] = rgbw[c];
					}
				if (!exr_read(&back, path, n, names, LIMIT, 0, &err))
					fail_msg("%s", err.msg);
				for (int i = 0; i < W * H; i++)
					for (int k = 0; k < n; k++)
						assert_true(back.px[i * n + k] == image.px[i * channels + of[k]]);
				image_free(&back);
			}
			image_free(&image);
		}
}

static void same_bytes_on_any_threads(void **state)
{
	(void)state;
	struct image image = image_new(400, 300, 3);
	struct err err = { 0 };
	char *first = 0, *text;
	size_t size, n;
	for (int i = 0; i < 400 * 300 * 3; i++)
		image.px[i] = (float)((i * 2654435761u >> 20) % 1000) / 1000;
	for (int threads = 1; threads <= 4; threads++) {
		const char *path = scratch_path("a.exr");
		omp_set_num_threads(threads);
		assert_true(exr_write(path, &image, rgbw, EXR_HALF, 0, &err) && file_read(&text, &n, path, 1 << 24, &err));
		if (first) {
			assert_int_equal(n, size);
			assert_memory_equal(text, first, n);
			free(text);
		} else {
			first = text;
			size = n;
		}
	}
	free(first);
	image_free(&image);
}

/* Every file cut short and many with a flipped byte: an error or an image, never a crash. */
static void damage_does_no_harm(void **state)
{
	(void)state;
	struct image image = sample(3), back;
	struct err err = { 0 };
	char *data;
	size_t size;
	const char *path = scratch_path("a.exr");
	assert_true(exr_write(path, &image, rgbw, EXR_HALF, 0, &err) && file_read(&data, &size, path, 1 << 24, &err));
	image_free(&image);
	int accepted = 0;
	for (size_t i = 0; i < 1200; i++) {
		bool cut = i % 2;
		size_t at = (i < 800 ? i : i * 7919) % size;
		char *copy = mem_new(size, 1);
		memcpy(copy, data, size);
		if (!cut)
			copy[at] ^= (char)(1 << i % 8);
		struct err e = { 0 };
		if (exr_read(&back, scratch_write("b.exr", copy, cut ? at : size), 3, rgbw, LIMIT, 0, &e)) {
			assert_true((long)back.width * back.height <= LIMIT);
			accepted += cut;
		} else
			assert_true(err_is(&e));
		image_free(&back);
		free(copy);
	}
	assert_int_equal(accepted, 0);  // no file with a part missing passes for whole
	free(data);
}

static void limits_and_faults(void **state)
{
	(void)state;
	struct image image = sample(3), back;
	struct err err = { 0 };
	const char *path = scratch_path("a.exr");
	assert_true(exr_write(path, &image, rgbw, EXR_HALF, 0, &err));
	image_free(&image);
	assert_false(exr_read(&back, path, 3, rgbw, W * H - 1, 0, &err));
	ERR_HAS(err, "a.exr");
	err = (struct err){ 0 };
	assert_false(exr_read(&back, scratch_path("none.exr"), 3, rgbw, LIMIT, 0, &err));
	ERR_HAS(err, "none.exr");
	err = (struct err){ 0 };
	assert_false(exr_read(&back, scratch_text("text.exr", "no picture"), 3, rgbw, LIMIT, 0, &err));
	ERR_HAS(err, "text.exr");
}

/* A ramp across stays one, away from its ends, a spot keeps its sum and spreads as sigma says, in every row and column of any number of them. */
static void blur_spreads(void **state)
{
	(void)state;
	const double sigma = 2.3;
	for (int height = 40; height < 45; height++) {
		float px[45 * W];
		for (int i = 0; i < height * W; i++)
			px[i] = (float)(i % W);
		plane_blur(px, W, height, sigma);
		for (int i = 0; i < height * W; i++)
			if (i % W >= 10 && i % W < W - 10)
				NEAR(px[i], i % W, 1e-4);
		for (int y = 12; y < height - 12; y++) {
			double sum = 0, square[2] = { 0 };
			memset(px, 0, sizeof px);
			px[y * W + W / 2] = 1;
			plane_blur(px, W, height, sigma);
			for (int i = 0; i < height * W; i++) {
				sum += (double)px[i];
				square[0] += (double)px[i] * pow(i % W - W / 2, 2);
				square[1] += (double)px[i] * pow(i / W - y, 2);
			}
			NEAR(sum, 1, 1e-5);
			for (int k = 0; k < 2; k++)
				NEAR(square[k], sigma * sigma, 2.0 / 3);  // boxes of 3 and of 5 px: sums of three variances lie 4 / 3 apart
		}
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(srgb_by_the_standard),
		cmocka_unit_test(bytes_are_the_nearest),
		cmocka_unit_test(sampling_is_bilinear),
		cmocka_unit_test(blur_spreads),
		SCRATCH_TEST(exr_round_trip),
		SCRATCH_TEST(channels_by_name), SCRATCH_TEST(red_stays_red),
		SCRATCH_TEST(any_subset_of_channels),
		SCRATCH_TEST(same_bytes_on_any_threads),
		SCRATCH_TEST(damage_does_no_harm),
		SCRATCH_TEST(limits_and_faults),
	};
	return cmocka_run_group_tests(tests, 0, 0);
}
