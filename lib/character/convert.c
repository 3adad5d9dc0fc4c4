#include "character/convert.h"

#include <limits.h>
#include <png.h>
#include <stb/stb_image.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <tiffio.h>

#include "base/mem.h"
#include "character/texture.h"
#include "image/webp.h"

void look_convert_ready(void)
{
	webp_missing();
}

static bool begins(const uint8_t *bytes, size_t size, const void *with, size_t n)
{
	return size >= n && !memcmp(bytes, with, n);
}

static bool is_webp(const uint8_t *bytes, size_t size)
{
	return size >= 12 && begins(bytes, size, "RIFF", 4) && !memcmp(bytes + 8, "WEBP", 4);
}

static bool is_tiff(const uint8_t *bytes, size_t size)
{
	return begins(bytes, size, "II*", 4) || begins(bytes, size, "MM\0*", 4);
}

/* What stb would take for something else than TGA: that is not what the name says, and no kind that is to be read by it. */
static bool is_another(const uint8_t *bytes, size_t size)
{
	static const char *const magic[] = { "\x89PNG", "\xff\xd8", "GIF8", "8BPS", "\x53\x80\xf6\x34", "#?RADIANCE", "#?RGBE", "P5", "P6" };
	bool found = false;
	for (int i = 0; i < COUNT(magic); i++)
		found |= begins(bytes, size, magic[i], strlen(magic[i]));
	return found;
}

bool look_is_foreign(const char *name, const uint8_t *bytes, size_t size)
{
	const size_t n = strlen(name);
	return is_webp(bytes, size) || is_tiff(bytes, size) || begins(bytes, size, "BM", 2)
	       || (n > 4 && !strcasecmp(name + n - 4, ".tga") && !is_another(bytes, size));
}

/* Pixels of a picture: [height][width][channels], 3 or 4 of them, sRGB. free() */
struct pixels {
	uint8_t *px;
	int width, height, channels;
};

static bool fits(double width, double height, int most, struct err *err)
{
	return (width >= 1 && height >= 1 && width <= most && height <= most && width * height <= LOOK_TEXTURE_AREA)
	       || err_set(err, "has %.0f x %.0f px, must be at most %d a side and %d in all", width, height, most, LOOK_TEXTURE_AREA);
}

static bool read_webp(struct pixels *p, const uint8_t *bytes, size_t size, int most, struct err *err)
{
	struct webp_head head;
	if (webp_missing())
		return err_set(err, "is WebP, which cannot be read here: %s (Debian's package: libwebp7)", webp_missing());
	if (!webp_head(&head, bytes, size) || head.moves)
		return err_set(err, "is a damaged or moving WebP");
	if (!fits(head.width, head.height, most, err))
		return false;
	*p = (struct pixels){ .width = head.width, .height = head.height, .channels = head.alpha ? 4 : 3 };
	p->px = mem_array((size_t)p->width * (size_t)p->height * (size_t)p->channels, 1);
	return webp_decode(p->px, p->channels, &head, bytes, size) || err_set(err, "is a damaged WebP");
}

/* A TIFF in memory. */
struct tiff {
	const uint8_t *bytes;
	toff_t size, at;
};

static tmsize_t tiff_read(thandle_t handle, void *to, tmsize_t n)
{
	struct tiff *t = handle;
	const toff_t left = t->at < t->size ? t->size - t->at : 0;
	const tmsize_t got = n < 0 ? 0 : (toff_t)n < left ? n : (tmsize_t)left;
	memcpy(to, t->bytes + (got ? t->at : 0), (size_t)got);
	t->at += (toff_t)got;
	return got;
}

static tmsize_t tiff_write(thandle_t handle, void *from, tmsize_t n)
{
	(void)handle, (void)from, (void)n;
	return 0;
}

static toff_t tiff_seek(thandle_t handle, toff_t to, int whence)
{
	struct tiff *t = handle;
	return t->at = to + (whence == SEEK_CUR ? t->at : whence == SEEK_END ? t->size : 0);
}

static int tiff_close(thandle_t handle)
{
	(void)handle;
	return 0;
}

static toff_t tiff_size(thandle_t handle)
{
	return ((struct tiff *)handle)->size;
}

/* libtiff's RGBA has the colours of what is transparent multiplied by its alpha. */
static void take_rgba(struct pixels *p, const uint32_t *rgba)
{
	const size_t area = (size_t)p->width * (size_t)p->height;
	for (size_t i = 0; i < area; i++) {
		const unsigned alpha = TIFFGetA(rgba[i]), c[3] = { TIFFGetR(rgba[i]), TIFFGetG(rgba[i]), TIFFGetB(rgba[i]) };
		uint8_t *to = p->px + i * (size_t)p->channels;
		for (int k = 0; k < 3; k++) {
			const unsigned whole = p->channels == 3 || !alpha ? c[k] : (c[k] * 255 + alpha / 2) / alpha;
			to[k] = (uint8_t)(whole < 255 ? whole : 255);
		}
		if (p->channels == 4)
			to[3] = (uint8_t)alpha;
	}
}

static bool read_tiff(struct pixels *p, const uint8_t *bytes, size_t size, int most, struct err *err)
{
	struct tiff memory = { bytes, size, 0 };
	TIFFSetErrorHandler(0);
	TIFFSetWarningHandler(0);
	TIFF *tiff = TIFFClientOpen("texture", "rm", &memory, tiff_read, tiff_write, tiff_seek, tiff_close, tiff_size, 0, 0);
	uint32_t width = 0, height = 0, *rgba = 0;
	uint16_t samples = 3;
	if (!tiff)
		return err_set(err, "is a damaged TIFF");
	TIFFGetField(tiff, TIFFTAG_IMAGEWIDTH, &width);
	TIFFGetField(tiff, TIFFTAG_IMAGELENGTH, &height);
	TIFFGetFieldDefaulted(tiff, TIFFTAG_SAMPLESPERPIXEL, &samples);
	bool ok = fits(width, height, most, err);
	if (ok) {
		*p = (struct pixels){ .width = (int)width, .height = (int)height, .channels = samples == 2 || samples == 4 ? 4 : 3 };
		rgba = mem_array((size_t)width * height, sizeof *rgba);
		ok = TIFFReadRGBAImageOriented(tiff, width, height, rgba, ORIENTATION_TOPLEFT, 1) || err_set(err, "is a damaged TIFF, or one of a kind that is not read");
	}
	if (ok) {
		p->px = mem_array((size_t)width * height * (size_t)p->channels, 1);
		take_rgba(p, rgba);
	}
	free(rgba);
	TIFFClose(tiff);
	return ok;
}

static bool read_other(struct pixels *p, const uint8_t *bytes, size_t size, int most, struct err *err)
{
	int n;
	if (size > INT_MAX || !stbi_info_from_memory(bytes, (int)size, &p->width, &p->height, &n))
		return err_set(err, "is a damaged BMP or TGA");
	if (!fits(p->width, p->height, most, err))
		return false;
	p->channels = n == 2 || n == 4 ? 4 : 3;
	p->px = stbi_load_from_memory(bytes, (int)size, &p->width, &p->height, &n, p->channels);
	return p->px || err_set(err, "is a damaged BMP or TGA");
}

/* Level 1 of deflate: textures are large, and what leaves is compared by its pixels. */
static uint8_t *png_of(size_t *n, const struct pixels *p, struct err *err)
{
	png_image image = { .version = PNG_IMAGE_VERSION, .width = (png_uint_32)p->width, .height = (png_uint_32)p->height,
		                .format = p->channels == 4 ? PNG_FORMAT_RGBA : PNG_FORMAT_RGB, .flags = PNG_IMAGE_FLAG_FAST };
	png_alloc_size_t room = PNG_IMAGE_PNG_SIZE_MAX(image);
	uint8_t *out = mem_array(room, 1);
	if (png_image_write_to_memory(&image, out, &room, 0, p->px, 0, 0)) {
		*n = room;
		return out;
	}
	err_set(err, "cannot be kept as PNG: %s", image.message);
	free(out);
	return 0;
}

uint8_t *look_convert(size_t *n, const uint8_t *bytes, size_t size, int most, struct err *err)
{
	struct pixels p = { 0 };
	const bool ok = (is_webp(bytes, size) ? read_webp : is_tiff(bytes, size) ? read_tiff : read_other)(&p, bytes, size, most, err);
	uint8_t *png = ok ? png_of(n, &p, err) : 0;
	free(p.px);
	return png;
}
