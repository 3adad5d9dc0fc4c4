#include <stdlib.h>
#include <string.h>
#include <tiffio.h>

#include "base/mem.h"
#include "image/photo/impl.h"

enum { BLOCK_MAX = 1 << 30 };  // bytes of a strip or tile

/* libtiff's view of a file in memory. */
struct source {
	struct bytes file;
	uint64_t at;
	char why[160];
};

static tmsize_t feed(thandle_t h, void *out, tmsize_t n)
{
	struct source *s = h;
	uint64_t left = s->at < s->file.n ? s->file.n - s->at : 0;
	if ((uint64_t)n > left)
		n = (tmsize_t)left;
	memcpy(out, s->file.p + s->at, (size_t)n);
	s->at += (uint64_t)n;
	return n;
}

static tmsize_t no_write(thandle_t h, void *data, tmsize_t n)
{
	(void)h;
	(void)data;
	(void)n;
	return -1;
}

static toff_t seek(thandle_t h, toff_t to, int whence)
{
	struct source *s = h;
	s->at = to + (whence == SEEK_CUR ? s->at : whence == SEEK_END ? s->file.n : 0);
	return s->at;
}

static int no_close(thandle_t h)
{
	(void)h;
	return 0;
}

static toff_t size_of(thandle_t h)
{
	return ((struct source *)h)->file.n;
}

static int on_error(TIFF *tif, void *user, const char *module, const char *fmt, va_list ap)
{
	struct source *s = user;
	(void)tif;
	(void)module;
	if (!*s->why)
		vsnprintf(s->why, sizeof s->why, fmt, ap);
	return 1;
}

static int on_warning(TIFF *tif, void *user, const char *module, const char *fmt, va_list ap)
{
	(void)tif;
	(void)user;
	(void)module;
	(void)fmt;
	(void)ap;
	return 1;  // of unknown tags
}

/* Palettes and YCbCr: libtiff's own conversion to 8-bit colour; orientation is left to the caller. */
static bool read_converted(TIFF *tif, const struct photo *photo, uint16_t *rgb, struct source *s)
{
	TIFFRGBAImage image;
	char why[1024];
	if (!TIFFRGBAImageBegin(&image, tif, 1, why)) {
		snprintf(s->why, sizeof s->why, "%.150s", why);
		return false;
	}
	size_t n = (size_t)photo->width * (size_t)photo->height;
	uint32_t *raster = mem_array(n, sizeof *raster);
	image.orientation = image.req_orientation = ORIENTATION_TOPLEFT;
	bool ok = image.width == (uint32_t)photo->width && image.height == (uint32_t)photo->height
	          && TIFFRGBAImageGet(&image, raster, image.width, image.height) && !*s->why;
	TIFFRGBAImageEnd(&image);
	for (size_t i = 0; ok && i < n; i++) {
		rgb[3 * i] = (uint16_t)(TIFFGetR(raster[i]) * 257);
		rgb[3 * i + 1] = (uint16_t)(TIFFGetG(raster[i]) * 257);
		rgb[3 * i + 2] = (uint16_t)(TIFFGetB(raster[i]) * 257);
	}
	free(raster);
	return ok;
}

/* Layout of plain samples: blocks are strips or tiles; planar files hold one plane in each. */
struct layout {
	uint32_t width, height;  // of a block
	uint16_t samples, invert, photometric;
	bool tiled, planar;
};

static inline uint16_t sample_at(const void *block, size_t i, int bits)
{
	return bits == 16 ? ((const uint16_t *)block)[i] : (uint16_t)(((const uint8_t *)block)[i] * 257);
}

static void place(uint16_t *rgb, const struct photo *photo, const struct layout *l, const void *block, int x0,
                  int y0, int plane)
{
	int step = l->planar ? 1 : l->samples, colours = photo->grey ? 1 : 3;
	for (int y = y0; y < y0 + (int)l->height && y < photo->height; y++)
		for (int x = x0; x < x0 + (int)l->width && x < photo->width; x++) {
			size_t in = ((size_t)(y - y0) * l->width + (size_t)(x - x0)) * (size_t)step;
			uint16_t *out = rgb + 3 * ((size_t)y * (size_t)photo->width + (size_t)x);
			for (int c = 0; c < colours; c++)
				if (!l->planar || c == plane)
					out[c] = sample_at(block, in + (size_t)(l->planar ? 0 : c), photo->bits) ^ l->invert;
			if (photo->grey)
				out[1] = out[2] = out[0];
		}
}

static struct layout layout_of(TIFF *tif, const struct photo *photo)
{
	uint16_t planar = PLANARCONFIG_CONTIG;
	struct layout l = { (uint32_t)photo->width, (uint32_t)photo->height, 1, 0, 0, TIFFIsTiled(tif), false };
	TIFFGetFieldDefaulted(tif, TIFFTAG_SAMPLESPERPIXEL, &l.samples);
	TIFFGetFieldDefaulted(tif, TIFFTAG_PLANARCONFIG, &planar);
	TIFFGetField(tif, TIFFTAG_PHOTOMETRIC, &l.photometric);
	l.invert = l.photometric == PHOTOMETRIC_MINISWHITE ? 0xffff : 0;
	l.planar = planar == PLANARCONFIG_SEPARATE;
	if (l.tiled) {
		TIFFGetField(tif, TIFFTAG_TILEWIDTH, &l.width);
		TIFFGetField(tif, TIFFTAG_TILELENGTH, &l.height);
	} else {
		TIFFGetFieldDefaulted(tif, TIFFTAG_ROWSPERSTRIP, &l.height);
		l.height = l.height < (uint32_t)photo->height ? l.height : (uint32_t)photo->height;
	}
	return l;
}

static bool read_plain(TIFF *tif, const struct photo *photo, uint16_t *rgb, struct source *s)
{
	struct layout l = layout_of(tif, photo);
	if (l.photometric > PHOTOMETRIC_RGB)
		return read_converted(tif, photo, rgb, s);
	int planes = l.planar ? (photo->grey ? 1 : 3) : 1;
	tmsize_t size = l.tiled ? TIFFTileSize(tif) : TIFFStripSize(tif);
	uint64_t want = (uint64_t)l.width * l.height * (l.planar ? 1u : l.samples) * (uint64_t)photo->bits / 8;
	if (!l.width || !l.height || size <= 0 || (uint64_t)size != want || want > BLOCK_MAX)
		return false;
	void *block = mem_array((size_t)size, 1);
	bool ok = true;
	for (int plane = 0; plane < planes && ok; plane++)
		for (int y = 0; y < photo->height && ok; y += (int)l.height)
			for (int x = 0; x < photo->width && ok; x += (int)l.width) {
				uint32_t at = l.tiled ? TIFFComputeTile(tif, (uint32_t)x, (uint32_t)y, 0, (uint16_t)plane)
				                      : TIFFComputeStrip(tif, (uint32_t)y, (uint16_t)plane);
				memset(block, 0, (size_t)size);
				ok = (l.tiled ? TIFFReadEncodedTile(tif, at, block, size)
				              : TIFFReadEncodedStrip(tif, at, block, size)) > 0 && !*s->why;
				place(rgb, photo, &l, block, x, y, plane);
			}
	free(block);
	return ok;
}

bool photo_decode_tiff(const struct photo *photo, uint16_t *rgb, struct photo_space *space, struct bytes file, struct err *err)
{
	struct source s = { .file = file };
	TIFFOpenOptions *options = TIFFOpenOptionsAlloc();
	TIFFOpenOptionsSetErrorHandlerExtR(options, on_error, &s);
	TIFFOpenOptionsSetWarningHandlerExtR(options, on_warning, &s);
	TIFF *tif = TIFFClientOpenExt("photograph", "rm", &s, feed, no_write, seek, no_close, size_of, 0, 0, options);
	TIFFOpenOptionsFree(options);
	bool ok = tif && read_plain(tif, photo, rgb, &s);
	uint32_t size = 0;
	void *icc = 0;
	if (ok && TIFFGetField(tif, TIFFTAG_ICCPROFILE, &size, &icc))
		photo_space_take(space, (struct bytes){ icc, size });
	if (tif)
		TIFFClose(tif);
	return ok ? true : err_set(err, "is damaged (%s): save it again", *s.why ? s.why : "its pixels do not fit its header");
}
