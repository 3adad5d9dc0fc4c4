/* What the pages get as text and pictures: each encoding against its own definition. */
#include "tests/lib/unit.h"

#include <zlib.h>

#include "base/mem.h"
#include "draw/web/base64.h"
#include "draw/web/field.h"
#include "draw/web/packed.h"
#include "draw/web/pseudocolour.h"
#include "math/rng.h"

/* RFC 4648, section 10. */
static void base64_is_the_standards(void **state)
{
	(void)state;
	static const char *const cases[][2] = { { "", "" }, { "f", "Zg==" }, { "fo", "Zm8=" }, { "foo", "Zm9v" },
		                                    { "foob", "Zm9vYg==" }, { "fooba", "Zm9vYmE=" }, { "foobar", "Zm9vYmFy" } };
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		char *text = base64_encode(cases[i][0], strlen(cases[i][0]), "data:,");
		char *want = mem_printf("data:,%s", cases[i][1]);
		assert_string_equal(text, want);
		free(text);
		free(want);
	}
	char *high = base64_encode("\xfb\xff", 2, "");
	assert_string_equal(high, "+/8=");
	free(high);
}

/* What render/viewer/gl.js does: each byte comes back, be there no items, fewer than `back`, or any number. */
static void packed_bytes_come_back(void **state)
{
	(void)state;
	static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
	static const size_t cases[][3] = { { 0, 4, 4 }, { 12, 12, 12 }, { 12, 4, 24 }, { 3000, 12, 12 }, { 3000, 1, 300 }, { 3000, 4, 400 }, { 7, 1, 3 } };
	struct rng rng = { 9 };
	for (size_t i = 0; i < COUNT(cases); i++) {
		const size_t size = cases[i][0], item = cases[i][1], back = cases[i][2];
		uint8_t data[3000], apart[3000];
		for (size_t k = 0; k < size; k++)
			data[k] = (uint8_t)(256 * rng_uniform(&rng));
		json_t *json = packed_json(data, size, item, back);
		assert_int_equal(json_integer_value(json_object_get(json, "size")), size);
		assert_int_equal(json_integer_value(json_object_get(json, "item")), item);
		assert_int_equal(json_integer_value(json_object_get(json, "back")), back);
		const char *text = json_string_value(json_object_get(json, "deflate"));
		const size_t n = strlen(text);
		uint8_t *bytes = mem_new(n + 1, 1);
		for (size_t k = 0; k < n && text[k] != '='; k++)
			for (size_t bit = 6 * k; bit < 6 * k + 6; bit++)
				bytes[bit / 8] |= (uint8_t)(((strchr(digits, text[k]) - digits) >> (5 - bit % 6) & 1) << (7 - bit % 8));
		uLongf whole = sizeof apart;
		assert_int_equal(uncompress(apart, &whole, bytes, (uLong)n), Z_OK);
		assert_int_equal(whole, size);
		for (size_t k = 0, from = 0; k < item; k++)
			for (size_t at = k; at < size; at += item)
				assert_int_equal((uint8_t)(apart[from++] + (at >= back ? data[at - back] : 0)), data[at]);
		free(bytes);
		json_decref(json);
	}
}

/* What render/viewer/gl.js does. */
static void decode(double *out, const uint8_t *bytes, size_t size, double step, int width, int height, int channels)
{
	long row = (long)width * channels;
	int32_t *whole = mem_new((size_t)(row * height) + 1, sizeof *whole);
	size_t at = 0;
	for (long i = 0; i < row * height; i++) {
		uint32_t v = 0;
		for (int shift = 0;; shift += 7) {
			assert_true(at < size);
			v |= (uint32_t)(bytes[at] & 127) << shift;
			if (bytes[at++] < 128)
				break;
		}
		bool left = i % row >= channels, above = i >= row;
		uint32_t foretold = (left ? (uint32_t)whole[i - channels] : 0) + (above ? (uint32_t)whole[i - row] : 0)
		                    - (left && above ? (uint32_t)whole[i - row - channels] : 0);
		whole[i] = (int32_t)((v >> 1 ^ (v & 1 ? 0xffffffffu : 0)) + foretold);
		out[i] = step * whole[i];
	}
	assert_int_equal(at, size);
	free(whole);
}

static void check_field(const float *px, int width, int height, int channels, double step_wanted)
{
	size_t size;
	double step;
	long n = (long)width * height * channels;
	uint8_t *bytes = field_encode(&size, &step, px, width, height, channels);
	double *back = mem_new((size_t)n + 1, sizeof *back);
	assert_true(step == step_wanted);
	decode(back, bytes, size, step, width, height, channels);
	for (long i = 0; i < n; i++)
		NEAR(back[i], isfinite(px[i]) ? px[i] : 0, 0.5 * step);
	free(back);
	free(bytes);
}

static void fields_come_back_to_half_a_step(void **state)
{
	(void)state;
	enum { W = 19, H = 13, C = 3 };
	float px[W * H * C];
	struct rng rng = { 5 };
	for (int i = 0; i < W * H * C; i++)
		px[i] = (float)(200 * (rng_uniform(&rng) - 0.5));
	check_field(px, W, H, C, ldexp(1, -16));
	check_field(px, W * C, H, 1, ldexp(1, -16));
	px[40] = NAN;
	px[0] = INFINITY;
	check_field(px, W, H, C, ldexp(1, -16));
	px[0] = 3e4f;  // 2^15 and less: 31 bits hold it in steps of 2^-15
	check_field(px, W, H, C, ldexp(1, -15));
}

static void smooth_fields_take_a_byte_a_value(void **state)
{
	(void)state;
	enum { N = 64 };
	float px[N * N];
	size_t size;
	double step;
	for (int i = 0; i < N * N; i++)
		px[i] = 0.01f * (float)(i % N) + 0.02f * (float)(i / N);
	free(field_encode(&size, &step, px, N, N, 1));
	assert_true(size < N * N + 4 * N);
}

static void a_scalars_ends_are_the_ramps(void **state)
{
	(void)state;
	struct image map = image_new(70, 40, 2);
	for (int i = 0; i < 70 * 40; i++) {
		map.px[2 * i] = -1;
		map.px[2 * i + 1] = (float)i;
	}
	double range[2];
	struct image rgb = pseudocolour_scalar(&map, 1, range);
	NEAR(range[0], 28, 8);  // the first and last hundredth of 2800
	NEAR(range[1], 2771, 8);
	assert_true(rgb.px[2] > rgb.px[1]);                       // blue below
	assert_true(rgb.px[3 * 2799 + 1] > rgb.px[3 * 2799 + 2]); // yellow above
	image_free(&rgb);
	// An even plane has the same light everywhere.
	rgb = pseudocolour_relief(&map, range);
	for (int i = 1; i < 70 * 40; i++)
		assert_true(rgb.px[3 * i] == rgb.px[0]);
	image_free(&rgb);
	image_free(&map);
}

static void what_no_photograph_saw_is_striped(void **state)
{
	(void)state;
	struct image map = image_new(20, 20, 4), mask = image_new(20, 20, 1);
	for (int i = 0; i < 400; i++) {
		for (int c = 0; c < 3; c++)
			map.px[4 * i + c] = 0.5f;
		map.px[4 * i + 3] = i < 200;
		mask.px[i] = i % 20 < 10;
	}
	struct image seen = pseudocolour_seen(&map), masked = pseudocolour_mask(&mask, &map);
	NEAR(seen.px[0], 0.5, 1e-6);
	assert_true(seen.px[3 * 399] < 0.03f);
	NEAR(masked.px[3 * 45], 0.5, 1e-6);          // inside: as it is
	NEAR(masked.px[3 * 55], 0.55 * 0.5, 1e-6);   // outside: dimmed
	assert_true(masked.px[3 * 50] == 1.0f);      // the outline
	image_free(&seen);
	image_free(&masked);
	image_free(&map);
	image_free(&mask);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(base64_is_the_standards), cmocka_unit_test(packed_bytes_come_back),
		cmocka_unit_test(fields_come_back_to_half_a_step),
		cmocka_unit_test(smooth_fields_take_a_byte_a_value),
		cmocka_unit_test(a_scalars_ends_are_the_ramps),
		cmocka_unit_test(what_no_photograph_saw_is_striped),
	};
	return cmocka_run_group_tests(tests, 0, 0);
}
