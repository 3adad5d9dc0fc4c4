/* Decoding by the formats' own C libraries: a program that links OpenCV's image codecs spends 0.15 s on loading
 * what they link in turn, before main. Warnings count: a picture with a damaged middle is refused, not half shown.
 */
#include <png.h>
#include <setjmp.h>
#include <stdlib.h>
#include <string.h>
#include <turbojpeg.h>

#include "base/mem.h"
#include "image/photo/impl.h"

void photo_widen(uint16_t *out, const uint8_t *in, size_t n)
{
	for (size_t i = 0; i < n; i++)
		out[i] = (uint16_t)(in[i] * 257);
}

uint8_t *photo_narrow(uint16_t *rgb, size_t n)
{
	return (uint8_t *)rgb + n;
}

void photo_widen_in_place(uint16_t *rgb, size_t n)
{
	const uint8_t *in = photo_narrow(rgb, n);
	size_t from = 0;
	// half of what is left at a time ends before the bytes that are read begin
	while (n - from > 1) {
		const size_t to = from + (n - from) / 2;
		photo_widen(rgb + from, in + from, to - from);
		from = to;
	}
	if (n > from)
		rgb[from] = (uint16_t)(in[from] * 257);
}

/* Cameras write these and mean no harm. */
static bool is_harmless(const char *warning)
{
	return strstr(warning, "extraneous bytes before marker") || strstr(warning, "Unknown Adobe color transform");
}

void photo_reduce_jpeg(struct photo *photo, int side)
{
	static const tjscalingfactor factors[] = { { 1, 8 }, { 1, 4 }, { 1, 2 } };
	for (int i = 0; i < COUNT(factors); i++) {
		const int width = TJSCALED(photo->width, factors[i]), height = TJSCALED(photo->height, factors[i]);
		if (width < side || height < side)
			continue;
		photo->width = width;
		photo->height = height;
		return;
	}
}

bool photo_decode_jpeg(const struct photo *photo, uint16_t *rgb, struct photo_space *space, struct bytes file, struct err *err)
{
	size_t n = (size_t)photo->width * (size_t)photo->height * 3;
	tjhandle tj = tjInitDecompress();
	if (!tj)
		return err_set(err, "cannot start the JPEG decoder");
	uint8_t *px = photo_narrow(rgb, n);
	int flags[] = { TJFLAG_ACCURATEDCT | TJFLAG_STOPONWARNING, TJFLAG_ACCURATEDCT };
	bool ok = false;
	char why[256] = "";
	for (int i = 0; i < COUNT(flags) && !ok; i++) {
		int bad = tjDecompress2(tj, file.p, file.n, px, photo->width, 0, photo->height, TJPF_RGB, flags[i]);
		snprintf(why, sizeof why, "%s", tjGetErrorStr2(tj));
		ok = !bad || (flags[i] == TJFLAG_ACCURATEDCT && is_harmless(why));
		if (!ok && !is_harmless(why))
			break;
	}
	tjDestroy(tj);
	if (ok) {
		photo_widen_in_place(rgb, n);
		photo_space_jpeg(space, file);
	}
	return ok ? true : err_set(err, "is damaged (%.200s): copy it from the camera again", why);
}

struct png_source {
	struct bytes file;
	size_t at;
	jmp_buf failed;
	char why[160];
};

static void png_feed(png_structp png, png_bytep out, size_t n)
{
	struct png_source *s = png_get_io_ptr(png);
	if (n > s->file.n - s->at)
		png_error(png, "ends too early");
	memcpy(out, s->file.p + s->at, n);
	s->at += n;
}

_Noreturn static void png_failed(png_structp png, const char *why)
{
	struct png_source *s = png_get_error_ptr(png);
	snprintf(s->why, sizeof s->why, "%s", why);
	longjmp(s->failed, 1);
}

static void png_warned(png_structp png, const char *why)
{
	(void)png;
	(void)why;  // of colour profiles and text chunks; pixels that do not fit their checksum are errors
}

/* Everything becomes RGB of the file's depth; rows: one pointer for each line. */
static bool read_rows(png_structp png, png_infop info, struct png_source *s, const struct photo *photo, struct photo_space *space,
                      png_bytep *rows)
{
	if (setjmp(s->failed))
		return false;
	// What is written into it is not read: a small file can hold gigabytes of compressed texts.
	png_set_keep_unknown_chunks(png, PNG_HANDLE_CHUNK_NEVER, (png_const_bytep) "tEXt\0zTXt\0iTXt", 3);
	png_set_read_fn(png, s, png_feed);
	png_set_user_limits(png, (png_uint_32)photo->width, (png_uint_32)photo->height);
	png_read_info(png, info);
	png_charp name;
	png_bytep icc;
	png_uint_32 size;
	int method;
	if (png_get_iCCP(png, info, &name, &method, &icc, &size))
		photo_space_take(space, (struct bytes){ icc, size });
	png_set_expand(png);
	png_set_strip_alpha(png);
	png_set_gray_to_rgb(png);
	if (photo->bits == 16)
		png_set_swap(png);
	png_set_interlace_handling(png);
	png_read_update_info(png, info);
	if (png_get_rowbytes(png, info) != (size_t)photo->width * 3 * (size_t)photo->bits / 8)
		png_error(png, "rows of another length than the header says");
	png_read_image(png, rows);
	png_read_end(png, 0);
	return true;
}

bool photo_decode_png(const struct photo *photo, uint16_t *rgb, struct photo_space *space, struct bytes file, struct err *err)
{
	struct png_source s = { .file = file };
	png_structp png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &s, png_failed, png_warned);
	png_infop info = png ? png_create_info_struct(png) : 0;
	if (!info)
		return err_set(err, "cannot start the PNG decoder");
	size_t line = (size_t)photo->width * 3, n = line * (size_t)photo->height;
	uint8_t *px = photo->bits == 8 ? photo_narrow(rgb, n) : 0;
	png_bytep *rows = mem_new((size_t)photo->height, sizeof *rows);
	for (size_t y = 0; y < (size_t)photo->height; y++)
		rows[y] = px ? px + y * line : (png_bytep)(rgb + y * line);
	bool ok = read_rows(png, info, &s, photo, space, rows);
	if (ok && px)
		photo_widen_in_place(rgb, n);
	png_destroy_read_struct(&png, &info, 0);
	free(rows);
	return ok ? true : err_set(err, "is damaged (%s): copy it again", s.why);
}
