/* Textures of kinds that glTF does not know, written here by hand: as PNG they have the same pixels; damaged ones are refused in one line. */
#include "base/file.h"
#include "character/convert.h"
#include "character/import.h"
#include "character/texture.h"
#include "tests/lib/scratch.h"
#include "tests/lib/unit.h"

enum { W = 5, H = 3 };

/* Colour and alpha of a pixel, rows downwards. */
static uint8_t want(int x, int y, int c)
{
	return (uint8_t)(c == 3 ? 255 - 40 * x : 30 * x + 50 * y + 20 * c);
}

struct file {
	uint8_t bytes[4096];
	size_t n;
};

static void put(struct file *f, int n, unsigned long x)
{
	for (int i = 0; i < n; i++)
		f->bytes[f->n++] = (uint8_t)(x >> 8 * i);
}

/* TGA 2.0: 18 bytes, then rows, blue first; from the bottom upwards unless bit 5 of the descriptor is set. */
static struct file tga(int channels, bool down, bool packed)
{
	struct file f = { .n = 0 };
	put(&f, 2, 0);
	put(&f, 1, packed ? 10 : 2);
	put(&f, 5, 0);
	put(&f, 4, 0);
	put(&f, 2, W);
	put(&f, 2, H);
	put(&f, 1, (unsigned long)(8 * channels));
	put(&f, 1, (channels == 4 ? 8 : 0) | (down ? 0x20 : 0));
	for (int i = 0; i < H; i++) {
		const int y = down ? i : H - 1 - i;
		if (packed)
			put(&f, 1, W - 1);  // a raw packet
		for (int x = 0; x < W; x++) {
			for (int c = 2; c >= 0; c--)
				put(&f, 1, want(x, y, c));
			if (channels == 4)
				put(&f, 1, want(x, y, 3));
		}
	}
	return f;
}

/* A Windows bitmap of 24 bits, rows of whole words from the bottom upwards. */
static struct file bmp(void)
{
	const int row = (3 * W + 3) / 4 * 4;
	struct file f = { .n = 0 };
	put(&f, 2, 0x4d42);
	put(&f, 4, (unsigned long)(54 + row * H));
	put(&f, 4, 0);
	put(&f, 4, 54);
	put(&f, 4, 40);
	put(&f, 4, W);
	put(&f, 4, H);
	put(&f, 2, 1);
	put(&f, 2, 24);
	for (int k = 0; k < 6; k++)
		put(&f, 4, 0);
	for (int y = H - 1; y >= 0; y--) {
		for (int x = 0; x < W; x++)
			for (int c = 2; c >= 0; c--)
				put(&f, 1, want(x, y, c));
		put(&f, row - 3 * W, 0);
	}
	return f;
}

static void tag(struct file *f, int which, int type, unsigned long count, unsigned long value)
{
	put(f, 2, (unsigned long)which);
	put(f, 2, (unsigned long)type);
	put(f, 4, count);
	put(f, 4, value);
}

/* TIFF 6.0, little-endian, one strip without compression; its fourth sample is unassociated alpha. */
static struct file tiff(int channels)
{
	enum { SHORT = 3, LONG = 4 };
	const unsigned long tags = channels == 4 ? 10 : 9, bits = 8 + 2 + 12 * tags + 4, strip = bits + 8;
	struct file f = { .n = 0 };
	put(&f, 4, 0x002a4949);
	put(&f, 4, 8);
	put(&f, 2, tags);
	tag(&f, 256, LONG, 1, W);
	tag(&f, 257, LONG, 1, H);
	tag(&f, 258, SHORT, (unsigned long)channels, bits);
	tag(&f, 259, SHORT, 1, 1);
	tag(&f, 262, SHORT, 1, 2);
	tag(&f, 273, LONG, 1, strip);
	tag(&f, 277, SHORT, 1, (unsigned long)channels);
	tag(&f, 278, LONG, 1, H);
	tag(&f, 279, LONG, 1, (unsigned long)(W * H * channels));
	if (channels == 4)
		tag(&f, 338, SHORT, 1, 2);
	put(&f, 4, 0);
	for (int k = 0; k < 4; k++)
		put(&f, 2, 8);
	for (int y = 0; y < H; y++)
		for (int x = 0; x < W; x++)
			for (int c = 0; c < channels; c++)
				put(&f, 1, want(x, y, c));
	return f;
}

static void check(const char *name, const struct file *f, int channels, int off)
{
	struct err err = { 0 };
	size_t n;
	int width, height;
	assert_true(look_is_foreign(name, f->bytes, f->n));
	uint8_t *png = look_convert(&n, f->bytes, f->n, 64, &err);
	if (!png)
		fail_msg("%s: %s", name, err.msg);
	struct look_texture t = { .bytes = png, .size = (long)n };
	assert_true(look_texture_check(&t, &err) && t.png && t.width == W && t.height == H);
	uint8_t *px = look_texture_pixels(&width, &height, &t, 64, &err);
	assert_non_null(px);
	for (int i = 0; i < W * H; i++) {
		const int alpha = channels == 4 ? want(i % W, i / W, 3) : 255;
		assert_int_equal(px[4 * i + 3], alpha);
		for (int c = 0; c < 3; c++)
			if (abs(px[4 * i + c] - want(i % W, i / W, c)) > off)
				fail_msg("%s: pixel %d, %d: %d of colour %d, must be %d", name, i % W, i / W, px[4 * i + c], c, want(i % W, i / W, c));
	}
	free(px);
	free(png);
}

static void pixels_are_kept(void **state)
{
	(void)state;
	for (int k = 0; k < 8; k++) {
		const struct file f = tga(3 + (k & 1), k & 2, k & 4);
		check("Skin.TGA", &f, 3 + (k & 1), 0);
	}
	const struct file b = bmp(), t3 = tiff(3), t4 = tiff(4);
	check("skin", &b, 3, 0);
	check("skin", &t3, 3, 0);
	check("skin", &t4, 4, 3);  // multiplied by an alpha of 95 and more, and divided again
}

/* Cut off anywhere, or with any byte wrong: pixels or one line. */
static void damage_is_said(void **state)
{
	(void)state;
	const struct file whole[] = { tga(4, false, true), bmp(), tiff(4) };
	uint32_t seed = 3;
	for (int k = 0; k < 3; k++)
		for (int i = 0; i < (int)whole[k].n + 600; i++) {
			struct file f = whole[k];
			struct err err = { 0 };
			size_t n;
			if (i < (int)f.n)
				f.n = (size_t)i;
			else {
				seed = seed * 1664525 + 1013904223;
				f.bytes[seed % (f.n < 60 ? f.n : 60)] = (uint8_t)(seed >> 24);
			}
			if (f.n < 4)
				continue;
			uint8_t *png = look_convert(&n, f.bytes, f.n, 64, &err);
			assert_true((png != 0) != err_is(&err));
			assert_null(strchr(err.msg, '\n'));
			free(png);
		}
	struct err err = { 0 };
	size_t n;
	struct file f = bmp();
	assert_null(look_convert(&n, f.bytes, f.n, 4, &err));
	assert_non_null(strstr(err.msg, "has 5 x 3 px, must be at most 4 a side"));
	assert_false(look_is_foreign("skin.png", (const uint8_t *)"\x89PNG\r\n", 6));
	assert_false(look_is_foreign("skin.tga", (const uint8_t *)"\x89PNG\r\n", 6));
	assert_false(look_is_foreign("skin.tga", (const uint8_t *)"8BPS\0\1", 6));
}

/* An OBJ whose material has a TGA: it comes in as PNG, in the process that reads strangers' bytes. */
static void a_character_wears_it(void **state)
{
	(void)state;
	static const struct character_limits limits = { 1000, 20, 1024 };
	struct mesh mesh;
	struct look look;
	struct err err = { 0 };
	const struct file f = tga(3, false, true);
	assert_true(file_write(scratch_path("skin.tga"), f.bytes, f.n, &err));
	scratch_text("quad.mtl", "newmtl skin\nKd 1 1 1\nmap_Kd skin.tga\n");
	scratch_text("quad.obj", "mtllib quad.mtl\nusemtl skin\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf 1/1 2/2 3/3 4/4\n");
	if (!character_import(&mesh, &look, scratch_path("."), "quad.obj", &limits, &err))
		fail_msg("%s", err.msg);
	assert_int_equal(look.n_textures, 1);
	assert_int_equal(look.n_left_out, 0);
	assert_true(look.texture[0].png && look.texture[0].width == W && look.texture[0].height == H);
	mesh_free(&mesh);
	look_free(&look);
}

int main(void)
{
	const struct CMUnitTest tests[] = { cmocka_unit_test(pixels_are_kept), cmocka_unit_test(damage_is_said), SCRATCH_TEST(a_character_wears_it) };
	return cmocka_run_group_tests(tests, 0, 0);
}
