/* Photographs: every format that is promised gives the pixels that went in; everything else is one clear line. */
#include "tests/lib/unit.h"

#include "bridge/cv_blur.h"
#include "base/file.h"
#include "base/mem.h"
#include "image/exr.h"
#include "image/photo/impl.h"
#include "image/photo/photo.h"
#include "image/picture.h"
#include "tests/lib/scratch.h"
#include "tests/lib/variants/variant.h"

enum { W = 70, H = 45 };

static struct photo load(struct blob file)
{
	struct photo photo;
	struct err err = { 0 };
	// The name says nothing true: kinds come from bytes.
	const char *path = scratch_write("photo.txt", file.data, file.size);
	if (!photo_load(&photo, path, 100, &err))
		fail_msg("%s", err.msg);
	free(file.data);
	return photo;
}

/* bits: of the file, how exact the values have to be. */
static void compare(struct photo *photo, int bits, bool grey)
{
	assert_int_equal(photo->width, W);
	assert_int_equal(photo->height, H);
	assert_int_equal(photo->bits, bits);
	assert_int_equal(photo->grey, grey);
	for (int y = 0; y < H; y++)
		for (int x = 0; x < W; x++)
			for (int c = 0; c < 3; c++) {
				uint16_t want = pattern_value(x, y, grey ? 0 : c), got = photo->rgb[3 * (y * W + x) + c];
				if (got != (bits == 8 ? (want >> 8) * 257 : want))
					fail_msg("(%d, %d) %d: %d, must be %d", x, y, c, got, want);
			}
	photo_free(photo);
}

static void png_is_exact(void **state)
{
	(void)state;
	for (int channels = 1; channels <= 4; channels += channels == 1 ? 2 : 1)
		for (int bits = 8; bits <= 16; bits += 8) {
			struct pixels p = pattern(W, H, channels);
			struct photo photo = load(encode_png(&p, bits));
			assert_int_equal(photo.kind, PHOTO_PNG);
			compare(&photo, bits, channels == 1);
			pixels_free(&p);
		}
}

static void tiff_is_exact(void **state)
{
	(void)state;
	static const int how[] = { AS_PLAIN, AS_PLANAR, AS_TILED, AS_LZW, AS_PLANAR | AS_TILED | AS_LZW,
		                   AS_BIG_ENDIAN, AS_BIG_ENDIAN | AS_TILED };
	for (int channels = 1; channels <= 4; channels += channels == 1 ? 2 : 1)
		for (int bits = 8; bits <= 16; bits += 8)
			for (size_t i = 0; i < sizeof how / sizeof *how; i++) {
				struct pixels p = pattern(W, H, channels);
				struct photo photo = load(encode_tiff(&p, bits, how[i], 1));
				assert_int_equal(photo.kind, PHOTO_TIFF);
				compare(&photo, bits, channels == 1);
				pixels_free(&p);
			}
}

/* JPEG is lossy. At quality 95 the quantiser's step is at most 12 of 255 in the highest frequencies and 2 in the lowest:
 * a ramp stays within 3; a channel mixed up or a colour transform left out is off by more than 20. */
static void jpeg_is_close(void **state)
{
	(void)state;
	for (int channels = 1; channels <= 3; channels += 2) {
		struct pixels p = { W, H, channels, mem_new((size_t)W * H * 3, 2) };
		for (int y = 0; y < H; y++)
			for (int x = 0; x < W; x++)
				for (int c = 0; c < channels; c++)
					p.px[(y * W + x) * channels + c] = (uint16_t)((60 + x + 40 * c + (c == 1) * y) * 257);
		struct photo photo = load(encode_jpeg(&p, 0));
		assert_int_equal(photo.kind, PHOTO_JPEG);
		assert_int_equal(photo.grey, channels == 1);
		for (int i = 0; i < W * H; i++)
			for (int c = 0; c < 3; c++)
				NEAR(photo.rgb[3 * i + c] / 257.0, p.px[i * channels + (channels == 3 ? c : 0)] / 257.0, 3);
		photo_free(&photo);
		pixels_free(&p);
	}
}

static void exr_is_linear(void **state)
{
	(void)state;
	static const char *const rgb[] = { "R", "G", "B" };
	struct image image = image_new(W, H, 3);
	struct err err = { 0 };
	struct photo photo;
	for (int i = 0; i < W * H * 3; i++)
		image.px[i] = (float)i / (W * H * 3);
	const char *path = scratch_path("photo.jpg");
	assert_true(exr_write(path, &image, rgb, EXR_FLOAT, 0, &err));
	assert_true(photo_load(&photo, path, 1, &err));
	assert_int_equal(photo.kind, PHOTO_EXR);
	struct image back = photo_linear(&photo, 0, 0, W, H);
	for (int i = 0; i < W * H * 3; i++)  // half a 16-bit sRGB step is at most 1.8e-5 in linear values
		NEAR(back.px[i], image.px[i], 2e-5);
	image_free(&back);
	image_free(&image);
	photo_free(&photo);
}

/* Where the stored pixel (x, y) has to stand in the upright picture: the picture of tag 274 in EXIF 2.3, by hand. */
static void upright(int o, int x, int y, int *u, int *v)
{
	int at[8][2] = { { x, y },         { W - 1 - x, y }, { W - 1 - x, H - 1 - y }, { x, H - 1 - y },
		         { y, x },         { H - 1 - y, x }, { H - 1 - y, W - 1 - x }, { y, W - 1 - x } };
	*u = at[o - 1][0];
	*v = at[o - 1][1];
}

static void numbers_are_widened_where_they_stand(void **state)
{
	(void)state;
	for (size_t n = 0; n < 70; n++) {
		uint16_t *rgb = mem_new(n + 1, sizeof *rgb);
		rgb[n] = 4711;
		for (size_t i = 0; i < n; i++)
			photo_narrow(rgb, n)[i] = (uint8_t)(91 * i + 7);
		photo_widen_in_place(rgb, n);
		for (size_t i = 0; i < n; i++)
			assert_int_equal(rgb[i], 257 * ((91 * i + 7) & 255));
		assert_int_equal(rgb[n], 4711);
		free(rgb);
	}
}

/* Each pixel of the upright picture is the one that EXIF's table names; sizes without a common factor, and with. */
static void large_ones_are_turned_where_they_stand(void **state)
{
	(void)state;
	static const int size[][2] = { { 7, 5 }, { 12, 8 }, { 1, 9 }, { 64, 64 }, { 101, 30 } };
	for (int k = 0; k < COUNT(size); k++)
		for (int o = 2; o <= 8; o++) {
			const int w = size[k][0], h = size[k][1], width = o >= 5 ? h : w, height = o >= 5 ? w : h;
			uint16_t (*rgb)[3] = mem_new((size_t)w * (size_t)h, sizeof *rgb);
			for (int i = 0; i < w * h; i++)
				for (int c = 0; c < 3; c++)
					rgb[i][c] = (uint16_t)(3 * i + c);
			photo_turn_in_place(rgb, o, w, h);
			// Which corner of the file is the upright picture's upper left, and along which side its rows run.
			static const int corner[9][2] = { [2] = { 1, 0 }, [3] = { 1, 1 }, [4] = { 0, 1 }, [5] = { 0, 0 }, [6] = { 0, 1 }, [7] = { 1, 1 }, [8] = { 1, 0 } };
			for (int v = 0; v < height; v++)
				for (int u = 0; u < width; u++) {
					const int along_x = o >= 5 ? v : u, along_y = o >= 5 ? u : v;
					const int x = corner[o][0] ? w - 1 - along_x : along_x, y = corner[o][1] ? h - 1 - along_y : along_y;
					assert_int_equal(rgb[v * width + u][1], 3 * (y * w + x) + 1);
				}
			free(rgb);
		}
}

static void orientation_is_applied(void **state)
{
	(void)state;
	struct pixels p = pattern(W, H, 3);
	for (int o = 1; o <= 8; o++) {
		struct photo photo = load(encode_tiff(&p, 16, AS_PLAIN, o));
		assert_int_equal(photo.exif.orientation, o);
		assert_int_equal(photo.width, o < 5 ? W : H);
		assert_int_equal(photo.height, o < 5 ? H : W);
		for (int y = 0; y < H; y++)
			for (int x = 0; x < W; x++) {
				int u, v;
				upright(o, x, y, &u, &v);
				assert_int_equal(photo.rgb[3 * (v * photo.width + u)], pattern_value(x, y, 0));
			}
		photo_free(&photo);
	}
	// The same through libexif, with 8-bit TIFF and with JPEG.
	struct blob jpeg = encode_jpeg(&p, 0);
	for (int o = 1; o <= 8; o++) {
		struct photo photo = load(with_exif(jpeg, &(struct exif_block){ o, -1, -1, -1, -1, -1 }));
		assert_int_equal(photo.width, o < 5 ? W : H);
		assert_int_equal(photo.exif.orientation, o);
		photo_free(&photo);
		photo = load(encode_tiff(&p, 8, AS_PLAIN, o));
		int u, v;
		upright(o, 3, 9, &u, &v);
		assert_int_equal(photo.rgb[3 * (v * photo.width + u)] >> 8, pattern_value(3, 9, 0) >> 8);
		photo_free(&photo);
	}
	free(jpeg.data);
	pixels_free(&p);
}

static void focal_length_where_it_can_be_believed(void **state)
{
	(void)state;
	struct pixels p = pattern(600, 400, 3);
	struct blob jpeg = encode_jpeg(&p, 0);
	double diagonal = hypot(600, 400) / 43.2666;
	const struct {
		struct exif_block exif;
		double focal_px;
	} cases[] = {
		{ { 1, 100, -1, -1, -1, -1 }, NAN },                       // of what sensor?
		{ { 1, 100, 150, -1, -1, -1 }, 150 * diagonal },           // CIPA: by the diagonal
		{ { 1, 100, 0, -1, -1, -1 }, NAN },                        // 0: unknown, EXIF 2.3
		{ { 1, 100, -1, 250, -1, -1 }, 2500 },                     // 600 px at 25 px/mm: 24 mm, 100 mm lens
		{ { 1, 100, 150, 250, -1, -1 }, 2500 },                    // 150 by diagonal is 2500: both agree
		{ { 1, 100, 250, 250, -1, -1 }, NAN },                     // they contradict each other
		{ { 1, 100, -1, 2500, 6000, 4000 }, 2500 },                // a tenth of the camera's picture
		{ { 1, 100, 150, 250, 600, 300 }, NAN },                   // cropped
		{ { 1, 100, -1, 0.5, -1, -1 }, NAN },                      // a sensor of 12 m
		{ { 6, 100, 150, -1, -1, -1 }, 150 * diagonal },           // turning changes nothing
	};
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		struct photo photo = load(with_exif(jpeg, &cases[i].exif));
		if (isnan(cases[i].focal_px) != isnan(photo.exif.focal_px))
			fail_msg("case %zu: focal_px = %g", i, photo.exif.focal_px);
		if (isfinite(cases[i].focal_px))
			NEAR(photo.exif.focal_px, cases[i].focal_px, 0.002 * cases[i].focal_px);  // rounding in EXIF: 150 for 150.1
		photo_free(&photo);
	}
	free(jpeg.data);
	pixels_free(&p);
}

static void refused(const char *what, const void *data, size_t size, const char *says)
{
	struct photo photo;
	struct err err = { 0 };
	const char *path = scratch_write("photo.jpg", data, size);
	if (photo_load(&photo, path, 100, &err))
		fail_msg("%s was accepted", what);
	ERR_HAS(err, says);
	ERR_HAS(err, "photo.jpg: ");
	assert_null(strchr(err.msg, '\n'));
	assert_null(photo.rgb);
}

static void refused_blob(const char *what, struct blob b, const char *says)
{
	refused(what, b.data, b.size, says);
	free(b.data);
}

/* The PNG with n empty chunks of text before its picture. */
static struct blob with_texts(struct blob png, size_t n)
{
	enum { HEAD = 8 + 25, CHUNK = 12 };
	struct blob out = { mem_new(png.size + n * CHUNK, 1), png.size + n * CHUNK };
	memcpy(out.data, png.data, HEAD);
	for (size_t i = 0; i < n; i++)
		memcpy(out.data + HEAD + i * CHUNK, "\0\0\0\0tEXt\xbf\xa5\xd2\xc2", CHUNK);
	memcpy(out.data + HEAD + n * CHUNK, png.data + HEAD, png.size - HEAD);
	free(png.data);
	return out;
}

static void faults_are_one_clear_line(void **state)
{
	(void)state;
	struct pixels p = pattern(200, 150, 3), q = pattern(200, 150, 4), tiny = pattern(10, 10, 3);
	struct blob b;
	refused("nothing", "", 0, "is empty");
	refused("text", "hello, world\n", 13, "is no photograph");
	refused("one byte", "\xff", 1, "is no photograph");
	refused("BMP", "BM..............", 16, "save it as PNG");
	refused("HEIC", "\0\0\0\x18" "ftypheic", 12, "is damaged");
	refused("WebP", "RIFF\x40\0\0\0WEBPVP8 ", 16, "truncated");
	refused("raw", "II*\0\x10\0\0\0CR\2\0", 12, "raw file");
	refused("BigTIFF", "II+\0\x08\0\0\0", 8, "BigTIFF");
	refused_blob("CMYK JPEG", encode_jpeg(&q, 1), "CMYK");
	refused_blob("CMYK TIFF", encode_tiff(&q, 8, AS_CMYK, 1), "CMYK");
	refused_blob("float TIFF", encode_tiff(&p, 16, AS_FLOAT, 1), "floating-point");
	refused_blob("tiny PNG", encode_png(&tiny, 8), "at least 16 x 16");
	b = encode_jpeg(&p, 0);
	claim_size(b, 20000, 10000);
	refused_blob("200-megapixel JPEG", b, "200 megapixels: must be <= 100 (limit.photo_mpx)");
	b = encode_png(&p, 8);
	claim_size(b, 2000000000, 2000000000);
	refused_blob("huge PNG", b, "megapixels");
	refused_blob("PNG of texts", with_texts(encode_png(&p, 8), 100000), "more than 100000 PNG chunks");
	b = encode_png(&p, 8);
	b.data[b.size / 2] ^= 0x55;
	refused_blob("PNG with a flipped bit", b, "is damaged");
	b = encode_jpeg(&p, 0);
	for (size_t i = b.size / 2; i < b.size / 2 + 40; i++)
		b.data[i] = 0xfe;  // no code of it is in the tables
	refused_blob("JPEG with a hole", b, "is damaged");
	pixels_free(&p);
	pixels_free(&q);
	pixels_free(&tiny);
}

/* Shrunk by any ratio a photograph is the mean over areas: that of OpenCV's area filter, and a constant stays what it is. */
static void shrunk_is_the_mean_of_areas(void **state)
{
	(void)state;
	enum { X = 3, Y = 5, WIDE = 187, HIGH = 131 };
	struct photo photo = { .width = 200, .height = 150, .bits = 16, .rgb = mem_new(200 * 150 * 3, sizeof *photo.rgb) };
	for (int i = 0; i < 200 * 150 * 3; i++)
		photo.rgb[i] = (uint16_t)(i * 2654435761u >> 16);
	const int sizes[][2] = { { 187, 131 }, { 100, 130 }, { 62, 44 }, { 17, 13 }, { 1, 1 } };
	struct image all = photo_linear(&photo, X, Y, WIDE, HIGH);
	for (int k = 0; k < COUNT(sizes); k++) {
		struct err err = { 0 };
		struct image got = photo_shrunk(&photo, X, Y, WIDE, HIGH, sizes[k][0], sizes[k][1]), want = image_new(sizes[k][0], sizes[k][1], 3);
		assert_true(cv_resize(want.px, want.width, want.height, all.px, all.width, all.height, 3, &err));
		double sum = 0, mean = 0;
		for (long i = 0; i < 3L * got.width * got.height; i++) {
			NEAR(got.px[i], want.px[i], 2e-6);  // OpenCV sums in single precision
			sum += got.px[i];
		}
		for (long i = 0; i < 3L * WIDE * HIGH; i++)
			mean += all.px[i];
		NEAR(sum / ((double)got.width * got.height), mean / (WIDE * HIGH), 1e-6);  // nothing is lost or counted twice
		image_free(&got);
		image_free(&want);
	}
	image_free(&all);
	photo_free(&photo);
}

/* Cut anywhere, a file is refused, never decoded in part and never read past its end. */
static void truncation_is_noticed(void **state)
{
	(void)state;
	struct pixels p = pattern(W, H, 3);
	struct blob files[] = { encode_jpeg(&p, 0), encode_png(&p, 8), encode_png(&p, 16), encode_tiff(&p, 8, 0, 1),
		                encode_tiff(&p, 16, AS_LZW | AS_TILED, 1) };
	for (int f = 0; f < COUNT(files); f++) {
		for (size_t n = 0; n < files[f].size; n += n < 600 || n > files[f].size - 40 ? 1 : 37) {
			struct photo photo;
			struct err err = { 0 };
			uint8_t *cut = mem_array(n, 1);  // of its own, so that the sanitiser sees the end
			memcpy(cut, files[f].data, n);
			if (photo_header(&photo, cut, n, 100, &err)) {
				const char *path = scratch_write("cut", cut, n);
				if (photo_load(&photo, path, 100, &err))
					fail_msg("file %d cut to %zu of %zu bytes was accepted", f, n, files[f].size);
			}
			assert_true(err_is(&err));
			free(cut);
		}
		free(files[f].data);
	}
	pixels_free(&p);
}

static void no_file(void **state)
{
	(void)state;
	struct photo photo;
	struct err err = { 0 };
	scratch_text("folder.jpg/x", "x");
	assert_false(photo_load(&photo, scratch_path("folder.jpg"), 100, &err));
	ERR_HAS(err, "is a folder");
	err = (struct err){ 0 };
	assert_false(photo_load(&photo, scratch_path("none.jpg"), 100, &err));
	ERR_HAS(err, "No such file");
	photo_free(&photo);
}

static void linear_crop(void **state)
{
	(void)state;
	for (int bits = 8; bits <= 16; bits += 8) {
		struct pixels p = pattern(W, H, 3);
		struct photo photo = load(encode_png(&p, bits));
		struct image image = photo_linear(&photo, 10, 7, 20, 30);
		for (int y = 0; y < 30; y++)
			for (int x = 0; x < 20; x++)
				for (int c = 0; c < 3; c++) {
					// IEC 61966-2-1, in double; the table is float: 1e-6 is a few of its roundings.
					double v = photo.rgb[3 * ((y + 7) * W + x + 10) + c] / 65535.0;
					double want = v <= 0.04045 ? v / 12.92 : pow((v + 0.055) / 1.055, 2.4);
					NEAR(image_at(&image, x, y)[c], want, 1e-6);
				}
		image_free(&image);
		photo_free(&photo);
		pixels_free(&p);
	}
}

/* A disc of red in the left half; a reduced one shows the same in the same places. */
static void large_jpegs_come_smaller(void **state)
{
	(void)state;
	enum { WIDE = 403, HIGH = 299 };
	struct err err = { 0 };
	uint8_t *px = mem_new((size_t)WIDE * HIGH * 3, 1), *jpeg;
	size_t size;
	for (int y = 0; y < HIGH; y++)
		for (int x = 0; x < WIDE; x++)
			px[3 * (y * WIDE + x)] = hypot(x - 100, y - 150) < 60 ? 200 : 20;
	assert_true(picture_jpeg_encode(&jpeg, &size, px, WIDE, HIGH, 3, 95, &err));
	const char *path = scratch_write("large.jpg", jpeg, size);
	static const struct { int side, width, height; } of[] = { { 0, 403, 299 }, { 299, 403, 299 }, { 151, 403, 299 }, { 150, 202, 150 }, { 75, 101, 75 }, { 30, 51, 38 }, { 1, 51, 38 } };
	for (int i = 0; i < COUNT(of); i++) {
		struct photo photo;
		assert_true(photo_load_small(&photo, path, of[i].side, 100, &err));
		assert_int_equal(photo.width, of[i].width);
		assert_int_equal(photo.height, of[i].height);
		const double scale = (double)photo.width / WIDE;
		assert_in_range(photo.rgb[3 * ((int)(150 * scale) * photo.width + (int)(100 * scale))], 190 * 257, 210 * 257);
		assert_in_range(photo.rgb[3 * ((int)(150 * scale) * photo.width + (int)(300 * scale))], 10 * 257, 30 * 257);
		photo_free(&photo);
	}
	free(jpeg);
	free(px);
}

static void pictures_go_out_and_come_back(void **state)
{
	(void)state;
	struct err err = { 0 };
	uint8_t px[W * H * 4], *back;
	size_t size;
	int w, h;
	for (int channels = 1; channels <= 4; channels += channels == 1 ? 2 : 1) {
		for (int i = 0; i < W * H * channels; i++)
			px[i] = (uint8_t)(i * 31 >> 2);
		const char *path = scratch_path("picture.png");
		assert_true(picture_png_write(path, px, W, H, channels, &err));
		assert_true(picture_read(&back, &w, &h, path, 1, &err));
		assert_true(w == W && h == H);
		for (int i = 0; i < W * H; i++)
			for (int c = 0; c < 3; c++)
				assert_int_equal(back[3 * i + c], px[i * channels + (channels == 1 ? 0 : c)]);
		free(back);
		assert_true(picture_jpeg_encode(&back, &size, px, W, H, channels, 90, &err));
		assert_true(size > 100 && back[0] == 0xff && back[size - 1] == 0xd9);
		free(back);
	}
	assert_false(picture_png_write(scratch_path("p.png"), px, W, 0, 3, &err));
	ERR_HAS(err, "cannot be");
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		SCRATCH_TEST(png_is_exact),
		SCRATCH_TEST(tiff_is_exact),
		SCRATCH_TEST(jpeg_is_close),
		SCRATCH_TEST(exr_is_linear),
		SCRATCH_TEST(orientation_is_applied),
		cmocka_unit_test(numbers_are_widened_where_they_stand),
		cmocka_unit_test(large_ones_are_turned_where_they_stand),
		SCRATCH_TEST(focal_length_where_it_can_be_believed),
		cmocka_unit_test(shrunk_is_the_mean_of_areas),
		SCRATCH_TEST(faults_are_one_clear_line),
		SCRATCH_TEST(truncation_is_noticed),
		SCRATCH_TEST(no_file),
		SCRATCH_TEST(linear_crop),
		SCRATCH_TEST(large_jpegs_come_smaller),
		SCRATCH_TEST(pictures_go_out_and_come_back),
	};
	return cmocka_run_group_tests(tests, 0, 0);
}
