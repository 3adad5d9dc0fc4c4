#include "character/texture.h"

#include <png.h>
#include <stdlib.h>
#include <string.h>
#include <turbojpeg.h>

#include "base/mem.h"

static bool jpeg_head(struct look_texture *t)
{
	int sampling, space;
	tjhandle tj = tjInitDecompress();
	const bool ok = tj && !tjDecompressHeader3(tj, t->bytes, (unsigned long)t->size, &t->width, &t->height, &sampling, &space);
	if (tj)
		tjDestroy(tj);
	return ok;
}

static int be32(const uint8_t *p)
{
	return p[0] & 0x80 ? -1 : p[0] << 24 | p[1] << 16 | p[2] << 8 | p[3];
}

bool look_texture_check(struct look_texture *t, struct err *err)
{
	enum { PNG_HEAD = 33 };
	static const uint8_t png[8] = { 0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n' }, ktx[4] = { 0xab, 'K', 'T', 'X' };
	if (t->size >= 4 && !memcmp(t->bytes, ktx, sizeof ktx))
		return err_set(err, "is a KTX texture: save it as PNG or JPEG");
	t->png = t->size >= PNG_HEAD && !memcmp(t->bytes, png, sizeof png);
	if (t->png) {
		t->width = be32(t->bytes + 16);
		t->height = be32(t->bytes + 20);
	} else if (t->size < 4 || t->bytes[0] != 0xff || t->bytes[1] != 0xd8)
		return err_set(err, "is neither PNG, JPEG, WebP, TIFF, TGA nor BMP");
	else if (!jpeg_head(t))
		return err_set(err, "is a damaged JPEG");
	if (t->width < 1 || t->height < 1 || t->width > LOOK_TEXTURE_PX || t->height > LOOK_TEXTURE_PX || (long)t->width * t->height > LOOK_TEXTURE_AREA)
		return err_set(err, "has %d x %d px, must be at most %d a side and %d in all", t->width, t->height, LOOK_TEXTURE_PX, LOOK_TEXTURE_AREA);
	return true;
}

/* The chunks of a PNG that its picture is made of, and how opaque it is. Texts and profiles would be unpacked, gigabytes of them where a stranger
 * likes; a texture's colours are sRGB whatever they say (glTF 2.0, 3.8.2). Returns their bytes, free(). */
static uint8_t *picture_chunks(size_t *size, const struct look_texture *t)
{
	enum { SIGNATURE = 8, AROUND = 12, NAME = 4 };  // of a chunk: length and name before its data, a sum behind
	uint8_t *out = mem_array((size_t)t->size + 1, 1);
	memcpy(out, t->bytes, SIGNATURE);
	*size = SIGNATURE;
	for (long at = SIGNATURE; at + AROUND <= t->size;) {
		const long length = be32(t->bytes + at);
		if (length < 0 || length > t->size - at - AROUND)
			break;
		const uint8_t *name = t->bytes + at + NAME;
		if (!(name[0] & 0x20) || !memcmp(name, "tRNS", NAME)) {
			memcpy(out + *size, t->bytes + at, (size_t)(length + AROUND));
			*size += (size_t)(length + AROUND);
		}
		at += length + AROUND;
	}
	return out;
}

static uint8_t *decode_png(const struct look_texture *t, struct err *err)
{
	png_image image = { .version = PNG_IMAGE_VERSION };
	size_t size;
	uint8_t *px = 0, *chunks = picture_chunks(&size, t);
	if (!png_image_begin_read_from_memory(&image, chunks, size)) {
		err_set(err, "is a damaged PNG: %s", image.message);
		free(chunks);
		return 0;
	}
	image.format = PNG_FORMAT_RGBA;
	image.flags |= PNG_IMAGE_FLAG_16BIT_sRGB;
	if ((int)image.width == t->width && (int)image.height == t->height)
		px = mem_array(4 * (size_t)t->width * (size_t)t->height, 1);
	if (!px || !png_image_finish_read(&image, 0, px, 0, 0)) {
		err_set(err, "is a damaged PNG: %s", image.message);
		png_image_free(&image);
		free(px);
		px = 0;
	}
	free(chunks);
	return px;
}

static uint8_t *decode_jpeg(const struct look_texture *t, struct err *err)
{
	uint8_t *px = mem_array(4 * (size_t)t->width * (size_t)t->height, 1);
	tjhandle tj = tjInitDecompress();
	const bool ok = tj && !tjDecompress2(tj, t->bytes, (unsigned long)t->size, px, t->width, 0, t->height, TJPF_RGBA, TJFLAG_ACCURATEDCT);
	if (!ok)
		err_set(err, "is a damaged JPEG: %.100s", tjGetErrorStr2(tj));
	if (tj)
		tjDestroy(tj);
	if (ok)
		return px;
	free(px);
	return 0;
}

/* Halves a picture in place; the last row or column of an odd one is left out. */
static void halve(uint8_t *px, int *width, int *height)
{
	const int w = *width / 2, h = *height / 2;
	for (int y = 0; y < h; y++)
		for (int x = 0; x < w; x++)
			for (int c = 0; c < 4; c++) {
				const uint8_t *p = px + 4 * ((size_t)(2 * y) * (size_t)*width + (size_t)(2 * x)) + c, *q = p + 4 * (size_t)*width;
				px[4 * ((size_t)y * (size_t)w + (size_t)x) + (size_t)c] = (uint8_t)((p[0] + p[4] + q[0] + q[4] + 2) / 4);
			}
	*width = w;
	*height = h;
}

uint8_t *look_texture_pixels(int *width, int *height, const struct look_texture *t, int longest, struct err *err)
{
	uint8_t *px = t->png ? decode_png(t, err) : decode_jpeg(t, err);
	*width = t->width;
	*height = t->height;
	while (px && (*width > longest || *height > longest) && *width > 1 && *height > 1)
		halve(px, width, height);
	return px;
}
