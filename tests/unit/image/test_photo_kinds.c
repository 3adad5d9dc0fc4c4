/* Photographs as telephones, browsers and cameras write them, and the colour space they were written in. Truth: colours by the
 * matrices of primaries that standards print. */
#include "tests/lib/unit.h"

#include "base/mem.h"
#include "image/colour.h"
#include "image/photo/photo.h"
#include "tests/lib/scratch.h"
#include "tests/lib/variants/kind.h"

enum { W = 64, H = 48 };

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

static struct photo load(struct blob file)
{
	struct photo photo;
	struct err err = { 0 };
	// The name says nothing true: kinds come from bytes.
	if (!photo_load(&photo, scratch_write("photo.txt", file.data, file.size), 100, &err))
		fail_msg("%s", err.msg);
	free(file.data);
	return photo;
}

static const char *refusal(struct blob file)
{
	static struct err err;
	struct photo photo;
	err = (struct err){ 0 };
	assert_false(photo_load(&photo, scratch_write("photo.jpg", file.data, file.size), 100, &err));
	free(file.data);
	return err.msg;
}

/* Patches of 8 x 8 px: colours an eye and its skin have, and some near the edge of the space; all of them lie within sRGB. */
static void patch(double rgb[3], int x, int y)
{
	static const double colour[][3] = { { 0.60, 0.45, 0.38 }, { 0.35, 0.45, 0.55 }, { 0.85, 0.80, 0.78 }, { 0.30, 0.20, 0.12 },
		                            { 0.45, 0.50, 0.30 }, { 0.05, 0.05, 0.06 }, { 0.70, 0.50, 0.50 }, { 0.55, 0.55, 0.55 } };
	const double *c = colour[(x / 8 + 3 * (y / 8)) % 8];
	for (int k = 0; k < 3; k++)
		rgb[k] = c[k];
}

static struct pixels patches(void)
{
	struct pixels p = { W, H, 3, mem_array((size_t)W * H * 3, 2) };
	for (int y = 0; y < H; y++)
		for (int x = 0; x < W; x++) {
			double rgb[3];
			patch(rgb, x, y);
			for (int c = 0; c < 3; c++)
				p.px[3 * (y * W + x) + c] = (uint16_t)(65535 * rgb[c] + 0.5);
		}
	return p;
}

/* Against the patches as seen in that space; tolerance in 8-bit steps. Lossy kinds are asked in the middle of a patch. */
static void compare(struct photo *photo, const struct space *space, bool lossy, double tolerance)
{
	assert_int_equal(photo->width, W);
	assert_int_equal(photo->height, H);
	double worst = 0, off = 0;
	for (int y = 4; y < H; y += 8)
		for (int x = 4; x < W; x += 8) {
			double rgb[3], want[3];
			patch(rgb, x, y);
			if (photo->bits == 8 || lossy)
				for (int c = 0; c < 3; c++)
					rgb[c] = ((int)(65535 * rgb[c] + 0.5) >> 8) / 255.0;
			space_to_srgb(want, space, rgb);
			for (int c = 0; c < 3; c++) {
				worst = fmax(worst, fabs(photo->rgb[3 * (y * W + x) + c] / 257.0 - 255 * want[c]));
				off = fmax(off, 255 * fabs(want[c] - rgb[c]));
			}
		}
	if (!(worst <= tolerance))
		fail_msg("%g of 255 off", worst);
	// The test could not fail if the space were sRGB's.
	assert_true(space == &space_srgb || off > 4 + tolerance);
	photo_free(photo);
}

static void profiles_are_honoured(void **state)
{
	(void)state;
	static const struct space *const spaces[] = { &space_p3, &space_adobe, &space_srgb };
	for (int s = 0; s < 3; s++) {
		struct pixels p = patches();
		struct photo photo = load(with_icc_png(encode_png(&p, 16), icc_of(spaces[s])));
		assert_int_equal(*photo.profile != 0, s < 2);
		compare(&photo, spaces[s], false, 0.4);
		photo = load(with_icc_png(encode_png(&p, 8), icc_of(spaces[s])));
		compare(&photo, spaces[s], false, 0.4);
		photo = load(with_icc_jpeg(encode_jpeg(&p, 0), icc_of(spaces[s]), 1));
		compare(&photo, spaces[s], true, 3);
		photo = load(with_icc_jpeg(encode_jpeg(&p, 0), icc_of(spaces[s]), 3));
		compare(&photo, spaces[s], true, 3);
		photo = load(with_icc_webp(encode_webp(&p), icc_of(spaces[s]), W, H));
		compare(&photo, spaces[s], false, 0.4);
		pixels_free(&p);
	}
}

/* The JPEG with an EXIF block (little-endian TIFF) that holds a colour space and an interoperability index alone. */
static struct blob with_marks(struct blob jpeg, int colour_space, char index)
{
	const uint8_t space[2] = { (uint8_t)colour_space, (uint8_t)(colour_space >> 8) };
	const uint8_t block[] = {
		0xff, 0xe1, 0, 2 + 6 + 74, 'E', 'x', 'i', 'f', 0, 0, 'I', 'I', '*', 0, 8, 0, 0, 0,
		1, 0, 0x69, 0x87, 4, 0, 1, 0, 0, 0, 26, 0, 0, 0, 0, 0, 0, 0,
		2, 0, 0x01, 0xa0, 3, 0, 1, 0, 0, 0, space[0], space[1], 0, 0,
		0x05, 0xa0, 4, 0, 1, 0, 0, 0, 56, 0, 0, 0, 0, 0, 0, 0,
		1, 0, 0x01, 0x00, 2, 0, 4, 0, 0, 0, 'R', '0', (uint8_t)index, 0, 0, 0, 0, 0,
	};
	struct blob out = { mem_array(jpeg.size + sizeof block, 1), jpeg.size + sizeof block };
	memcpy(out.data, jpeg.data, 2);
	memcpy(out.data + 2, block, sizeof block);
	memcpy(out.data + 2 + sizeof block, jpeg.data + 2, jpeg.size - 2);
	free(jpeg.data);
	return out;
}

/* Cameras that write Adobe RGB mark it in EXIF: R03, and a colour space that is not calibrated. A profile goes before the mark. */
static void adobe_rgb_by_exif(void **state)
{
	(void)state;
	struct pixels p = patches();
	struct photo photo = load(with_marks(encode_jpeg(&p, 0), 0xffff, '3'));
	assert_string_equal(photo.profile, "Adobe RGB");
	compare(&photo, &space_adobe, true, 3);
	photo = load(with_marks(encode_jpeg(&p, 0), 1, '3'));
	compare(&photo, &space_srgb, true, 3);
	photo = load(with_marks(encode_jpeg(&p, 0), 0xffff, '9'));
	compare(&photo, &space_srgb, true, 3);
	photo = load(with_marks(with_icc_jpeg(encode_jpeg(&p, 0), icc_of(&space_p3), 1), 0xffff, '3'));
	compare(&photo, &space_p3, true, 3);
	pixels_free(&p);
}

/* Three channels that are alike are a grey photograph. */
static void grey_in_three_channels(void **state)
{
	(void)state;
	struct pixels p = pattern(W, H, 3);
	for (int i = 0; i < W * H; i++)
		p.px[3 * i + 1] = p.px[3 * i + 2] = p.px[3 * i];
	struct photo photo = load(encode_jpeg(&p, 0));
	assert_true(photo.grey);
	photo_free(&photo);
	for (int i = 0; i < W * H; i++)
		p.px[3 * i + 2] = (uint16_t)(p.px[3 * i] * 0.95);
	photo = load(encode_png(&p, 8));
	assert_false(photo.grey);
	photo_free(&photo);
	pixels_free(&p);
}

/* A profile of sRGB leaves every value as it is, to the bit. */
static void srgb_is_untouched(void **state)
{
	(void)state;
	struct pixels p = pattern(W, H, 3);
	struct photo plain = load(encode_png(&p, 16)), told = load(with_icc_png(encode_png(&p, 16), icc_of(&space_srgb)));
	assert_memory_equal(plain.rgb, told.rgb, sizeof *plain.rgb * 3 * W * H);
	assert_string_equal(told.profile, "");
	photo_free(&plain);
	photo_free(&told);
	pixels_free(&p);
}

static void grey_profiles(void **state)
{
	(void)state;
	struct pixels p = { W, H, 1, mem_array((size_t)W * H, 2) };
	for (int i = 0; i < W * H; i++)
		p.px[i] = (uint16_t)(i % W * 1000);
	struct photo photo = load(with_icc_png(encode_png(&p, 16), icc_grey(1.8)));
	assert_true(photo.grey);
	for (int x = 8; x < W; x++) {
		double v = pow(p.px[x] / 65535.0, 1.8), want = v <= 0.0031308 ? 12.92 * v : 1.055 * pow(v, 1 / 2.4) - 0.055;
		NEAR(photo.rgb[3 * x] / 257.0, 255 * want, 0.4);
		// Neutral stays neutral, but for the rounding of the profile's white point.
		NEAR(photo.rgb[3 * x] / 257.0, photo.rgb[3 * x + 2] / 257.0, 0.1);
	}
	photo_free(&photo);
	pixels_free(&p);
}

static void bad_profiles_are_refused(void **state)
{
	(void)state;
	struct pixels p = patches();
	struct blob broken = icc_of(&space_p3);
	memset(broken.data, 0x5a, 64);
	assert_non_null(strstr(refusal(with_icc_jpeg(encode_jpeg(&p, 0), broken, 1)), "damaged colour profile"));
	assert_non_null(strstr(refusal(with_icc_jpeg(encode_jpeg(&p, 0), icc_printer(), 1)), "printer"));
	struct blob cut = icc_of(&space_p3);
	cut.size /= 3;
	assert_non_null(strstr(refusal(with_icc_jpeg(encode_jpeg(&p, 0), cut, 1)), "colour profile"));
	pixels_free(&p);
}

static void webp_is_exact(void **state)
{
	(void)state;
	struct pixels p = pattern(W, H, 3);
	struct photo photo = load(encode_webp(&p));
	assert_int_equal(photo.kind, PHOTO_WEBP);
	assert_int_equal(photo.bits, 8);
	for (int i = 0; i < 3 * W * H; i++)
		assert_int_equal(photo.rgb[i], (p.px[i] >> 8) * 257);
	photo_free(&photo);
	struct blob cut = encode_webp(&p);
	cut.size -= 9;
	assert_non_null(strstr(refusal(cut), "truncated"));
	pixels_free(&p);
}

/* Quality 100, no subsampling: patches of one colour come back to a step or two. */
static void heif_and_avif(void **state)
{
	(void)state;
	int met = 0;
	for (int avif = 0; avif < 2; avif++)
		// Debian 12's libheif has no encoder of AV1 with 10 bits: aom stops at an assertion.
		for (int bits = 8; bits <= (avif ? 8 : 10); bits += 2) {
			struct pixels p = patches();
			struct blob file = encode_heif(&p, bits, avif, (struct blob){ 0 }, 0);
			if (file.size) {
				met++;
				struct photo photo = load(file);
				assert_int_equal(photo.kind, PHOTO_HEIF);
				assert_int_equal(photo.bits, bits == 8 ? 8 : 16);
				compare(&photo, &space_srgb, true, 2.5);
				photo = load(encode_heif(&p, bits, avif, icc_of(&space_p3), 0));
				compare(&photo, &space_p3, true, 3);
				photo = load(encode_heif(&p, bits, avif, (struct blob){ 0 }, 12));
				compare(&photo, &space_p3, true, 3);
				struct blob cut = encode_heif(&p, bits, avif, (struct blob){ 0 }, 0);
				cut.size = cut.size * 2 / 3;
				assert_true(strlen(refusal(cut)) > 20);
			}
			pixels_free(&p);
		}
	if (!met)
		skip();
}

/* Patches of one colour through libraw: black level 0, white 65535, camera channels that are sRGB's. */
static void raw_is_developed(void **state)
{
	(void)state;
	static const uint16_t level[][4] = { { 20000, 20000, 20000, 20000 }, { 30000, 20000, 20000, 9000 }, { 9000, 14000, 14000, 26000 } };
	for (int i = 0; i < 3; i++)
		for (int turned = 0; turned < 2; turned++) {
			struct photo photo = load(encode_dng(96, 64, level[i], turned ? 6 : 1));
			assert_int_equal(photo.kind, PHOTO_RAW);
			assert_int_equal(photo.bits, 16);
			assert_int_equal(photo.width, turned ? 64 : 96);
			assert_int_equal(photo.height, turned ? 96 : 64);
			const uint16_t *px = photo.rgb + 3 * (40 * photo.width + 40), camera[3] = { level[i][0], level[i][1], level[i][3] };
			for (int c = 0; c < 3; c++) {
				double v = camera[c] / 65535.0, want = 1.055 * pow(v, 1 / 2.4) - 0.055;
				NEAR(px[c] / 257.0, 255 * want, 2.5);
			}
			photo_free(&photo);
		}
	struct blob cut = encode_dng(96, 64, level[0], 1);
	cut.size = 8 + 64 * 96;
	assert_true(strlen(refusal(cut)) > 20);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(profiles_are_honoured), cmocka_unit_test(srgb_is_untouched), cmocka_unit_test(grey_profiles),
		cmocka_unit_test(bad_profiles_are_refused), cmocka_unit_test(webp_is_exact), cmocka_unit_test(heif_and_avif),
		cmocka_unit_test(raw_is_developed), cmocka_unit_test(adobe_rgb_by_exif), cmocka_unit_test(grey_in_three_channels),
	};
	return cmocka_run_group_tests(tests, setup, teardown);
}
